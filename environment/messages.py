"""
Install the message packages in ``environment/messages.txt``, in addition to those in the lock.

They have a separate step and stamp, so that adding one installs one wheel and rebuilds nothing.  A
note in the venv lists the installed packages (:func:`environment.ros.further_messages`): only runs
that use such a package depend on it.
"""

from collections.abc import Iterable, Mapping, Sequence
import json
import os
from pathlib import Path
import re
from typing import Any

from environment import stamps
from environment.pins import canonical, PIN, pins_for
from environment.places import LOCK_FILE, MESSAGES_FILE, Places, write_atomically
from environment.plan import Plan
from environment.ros import further_messages, MESSAGES_NAME
from environment.steps import Job, StepError

TITLE = f'{MESSAGES_FILE.parent.name}/{MESSAGES_FILE.name}'
REQUIREMENT = re.compile(r'^(?P<name>[\w.-]+)\s*(?:(?P<sign>~=|==)\s*(?P<version>[\d.]+)$)?')
"""A requirement of a ROS wheel, such as ``ros-std-msgs~=5.3.6``."""
VERSION = re.compile(r'<version>\s*([\w.]+)\s*</version>')
"""The version in a package.xml."""


def wanted(text: str) -> dict[str, str]:
    """
    Parse ``messages.txt`` into pins.

    :returns: name -> version, such as ``'ros-trajectory-msgs'`` -> ``'5.3.6'``
    :raises StepError: if a line does not give the exact version of a ROS package
    """
    pins: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        entry = line.partition('#')[0].strip()
        if not entry:
            continue
        match = PIN.match(entry)
        name = canonical(match['name'] if match else re.split(r'[^\w.-]', entry)[0])
        bare = name.removeprefix('ros-').removeprefix('jazzy-')
        if not match or match['rest'] or name != f'ros-{bare}':
            version = match['version'] if match else 'VERSION'
            raise StepError(
                f'{TITLE}, line {number}: expected ros-NAME==VERSION, got {entry}',
                f'ros-{bare}=={version}' + ('' if match else f'; {_versions_of(bare)}'),
            )
        pins[name] = match['version']
    return pins


def _versions_of(bare: str) -> str:
    """Return the command that lists the versions of a package for Jazzy."""
    return f'to list its versions: .venv/bin/python -m pip index versions ros-jazzy-{bare}'


def package_of(name: str) -> str:
    """Return the ROS package of a wheel: ``trajectory_msgs`` for ``ros-trajectory-msgs``."""
    return name.removeprefix('ros-').replace('-', '_')


def install_messages(plan: Plan, job: Job) -> None:
    """Install the packages that the file lists, from wheels or from the sourced ROS 2."""
    pins = wanted(stamps.messages_text())
    if plan.kind == 'wheels':
        uses = _install_wheels(plan, job, pins)
    else:
        pins, uses = find_sourced(pins, plan.environ.get('AMENT_PREFIX_PATH', ''))
    note = {package_of(name): _closure(name, pins, uses) for name in pins}
    _write_note(plan.places, note)


def _write_note(places: Places, note: Mapping[str, Sequence[str]]) -> None:
    write_atomically(places.venv / MESSAGES_NAME, json.dumps(note, indent=1) + '\n')


def _closure(name: str, pins: Mapping[str, str], uses: Mapping[str, Iterable[str]]) -> list[str]:
    """Return the pins of a package and of all listed packages that it needs."""
    found, ahead = set(), [name]
    while ahead:
        one = ahead.pop()
        if one in pins and one not in found:
            found.add(one)
            ahead.extend(uses.get(one, ()))
    return sorted(f'{one}=={pins[one]}' for one in found)


# -- from PyPI ------------------------------------------------------------------------------


def _install_wheels(plan: Plan, job: Job, pins: Mapping[str, str]) -> dict[str, set[str]]:
    """Install the listed wheels, remove those no longer listed; return what each one uses."""
    places = plan.places
    lock = pins_for(LOCK_FILE.read_text(encoding='utf-8'), plan.python.version)
    for name in pins.keys() & lock.keys():
        raise StepError(f'{TITLE}: {name}=={lock[name]} is always installed', 'remove its line')
    pip = [str(places.python), '-m', 'pip', '--disable-pip-version-check', '--no-input']
    env = {**plan.clean_environ(), '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1'}
    before = further_messages(places.venv)
    uses: dict[str, set[str]] = {}
    if pins:
        chosen, report = places.notes / 'messages.txt', places.notes / 'messages.json'
        chosen.write_text(''.join(f'{n}=={v}\n' for n, v in pins.items()), encoding='utf-8')
        install = [*pip, 'install', '--progress-bar', 'off', '--no-deps', '--only-binary', ':all:']
        install += ['-r', str(chosen)]
        try:
            job.run([*install, '--dry-run', '--ignore-installed', '--report', str(report)], env)
        except StepError as error:
            raise StepError(
                f'{TITLE}: pip cannot install {", ".join(f"{n}=={v}" for n, v in pins.items())}',
                f'check names, versions and network; {_versions_of("NAME")}',
            ) from error
        uses = requirements(json.loads(report.read_text(encoding='utf-8')), {**lock, **pins})
        # Write the note first, so that the next set-up can remove a partial installation.
        _write_note(places, {**before, **{package_of(name): [] for name in pins}})
        job.run(install, env, 'pip')
    gone = {f'ros-{package.replace("_", "-")}' for package in before} - pins.keys() - lock.keys()
    if gone:
        job.run([*pip, 'uninstall', '--yes', *sorted(gone)], env, 'pip')
    return uses


def requirements(report: Mapping[str, Any], pins: Mapping[str, str]) -> dict[str, set[str]]:
    """
    Return the packages that each wheel requires.

    :param pins: name -> version of everything that is or will be installed
    :raises StepError: if a required package is missing or has an unsuitable version
    """
    found: dict[str, set[str]] = {}
    for item in report['install']:
        name, version = canonical(item['metadata']['name']), item['metadata']['version']
        found[name] = set()
        for text in item['metadata'].get('requires_dist', ()):
            match = REQUIREMENT.match(text)
            if match is None or 'extra ==' in text:
                continue
            other = canonical(match['name'])
            found[name].add(other)
            if other not in pins:
                raise StepError(
                    f'{TITLE}: {name} uses {other}, which is not installed',
                    f'add the line {other}=={match["version"] or "VERSION"}',
                )
            if not _suits(pins[other], match['sign'], match['version']):
                raise StepError(
                    f'{TITLE}: {name}=={version} requires {text}; the installed version of '
                    f'{other} is {pins[other]}',
                    f'choose a version for Jazzy; {_versions_of(name.removeprefix("ros-"))}',
                )
    return found


def _suits(version: str, sign: str | None, asked: str) -> bool:
    """Return whether a version satisfies ``~=`` or ``==``; with no sign, any version does."""
    if sign != '~=':
        return sign is None or version == asked
    series, _, patch = asked.rpartition('.')
    have, _, number = version.rpartition('.')
    return have == series and number.isdigit() and int(number) >= int(patch)


# -- from a sourced installation ------------------------------------------------------------


def find_sourced(
    pins: Mapping[str, str], prefixes: str
) -> tuple[dict[str, str], dict[str, set[str]]]:
    """
    Return the installed versions of the listed packages, and the packages that each one uses.

    :param pins: pins of ``messages.txt``; the installation determines the versions
    :param prefixes: search path of the installation, as in ``AMENT_PREFIX_PATH``
    :raises StepError: if the installation lacks a package
    """
    versions: dict[str, str] = {}
    uses: dict[str, set[str]] = {}
    for name in pins:
        package = package_of(name)
        files = (Path(p, 'share', package, 'package.xml') for p in prefixes.split(os.pathsep) if p)
        found = next((path for path in files if path.is_file()), None)
        if found is None:
            bare = name.removeprefix('ros-')
            raise StepError(
                f'{TITLE}: the sourced ROS 2 has no package {package}',
                f'with apt: sudo apt-get install -y ros-jazzy-{bare}',
            )
        text = found.read_text(encoding='utf-8')
        version = VERSION.search(text)
        versions[name] = version[1] if version else '?'
        uses[name] = {one for one in pins if f'>{package_of(one)}</' in text}
    return versions, uses
