"""
Read and merge exact pins: the lines of the lock file that apply to one Python.

The lock covers four Pythons; where they differ, lines have an environment marker. This module
understands only the markers that :func:`merge` writes, so it needs no packaging library.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
import re

# These are ROS packages, too: NumPy must be the version with which a sourced ROS 2 was compiled.
ROS_NAMES = {'numpy'}

PIN = re.compile(
    r'^(?P<name>[A-Za-z0-9][A-Za-z0-9._-]*)==(?P<version>[A-Za-z0-9.!+_-]+)(?P<rest>\s*;.*?)??'
    r'(?P<digests>(?:\s+--hash=sha256:[0-9a-f]{64})*)$'
)
MARKER = re.compile(r'python_version (==|>=|<) "3\.(\d+)"')


def canonical(name: str) -> str:
    """Return a project name in its normalised spelling, for comparisons."""
    return re.sub(r'[-_.]+', '-', name).lower()


def is_ros(name: str) -> bool:
    """Return whether a package is part of a sourced ROS 2 installation."""
    return name.startswith('ros-') or name in ROS_NAMES


def pins_for(text: str, python: str, *, ros: bool = True) -> dict[str, str]:
    """
    Return the pins of the lock for one Python.

    :param text: text of the lock file
    :param python: version of the Python, such as '3.12'
    :param ros: False omits packages that are part of a sourced ROS 2 installation
    :returns: name -> version
    """
    return {
        canonical(match['name']): match['version'] for match in _lines_for(text, python, ros=ros)
    }


def requirements_for(text: str, python: str, *, ros: bool = True) -> list[str]:
    """
    Return the requirements for one Python: one line per pin, with the digests of its files.

    :param text: text of the lock file
    :param python: version of the Python, such as '3.12'
    :param ros: as for :func:`pins_for`
    """
    return [
        f'{match["name"]}=={match["version"]}{match["digests"]}'
        for match in _lines_for(text, python, ros=ros)
    ]


def _lines_for(text: str, python: str, *, ros: bool) -> Iterator[re.Match[str]]:
    for line in text.splitlines():
        match = PIN.match(line)
        if not match or not applies(match['rest'] or '', _minor(python)):
            continue
        if ros or not is_ros(canonical(match['name'])):
            yield match


def applies(marker: str, minor: int) -> bool:
    """Evaluate an environment marker written by :func:`merge`."""
    tests = [
        {'==': minor == int(bound), '>=': minor >= int(bound), '<': minor < int(bound)}[sign]
        for sign, bound in MARKER.findall(marker)
    ]
    return any(tests) if ' or ' in marker else all(tests)


def merge(pins: Mapping[str, Mapping[str, str]]) -> list[str]:
    """
    Merge the pins of several Pythons into requirement lines.

    :param pins: for each Python ('3.12'), a dictionary name -> version
    :returns: sorted lines, with a marker where the Pythons differ
    """
    pythons = sorted(pins, key=_minor)
    lines = []
    for name in sorted({name for found in pins.values() for name in found}):
        versions: dict[str, list[str]] = {}
        for python in pythons:
            if name in pins[python]:
                versions.setdefault(pins[python][name], []).append(python)
        for version, used_by in versions.items():
            lines.append(f'{name}=={version}{_marker(used_by, pythons)}')
    return lines


def _marker(used_by: Sequence[str], pythons: Sequence[str]) -> str:
    """Return the environment marker of the Pythons that use a version, '' for all Pythons."""
    if list(used_by) == list(pythons):
        return ''
    first, last = used_by[0], used_by[-1]
    span = pythons[pythons.index(first) : pythons.index(last) + 1]
    if list(used_by) != list(span):
        return ' ; ' + ' or '.join(f'python_version == "{python}"' for python in used_by)
    bounds = [f'python_version >= "{first}"'] if first != pythons[0] else []
    bounds += [f'python_version < "3.{_minor(last) + 1}"'] if last != pythons[-1] else []
    return ' ; ' + ' and '.join(bounds)


def _minor(python: str) -> int:
    return int(python.split('.')[1])
