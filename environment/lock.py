"""
Write requirements.lock: `python -m environment lock`, for developers, with network access.

Every supported Python that is found resolves requirements.in separately; versions that differ get
an environment marker. Each line has the digests of its files, but no address or path: any mirror
can serve the files, and pip installs only files with these digests.
"""

from collections.abc import Iterable, Mapping, Sequence
import json
from pathlib import Path
import subprocess
import sys
import tempfile
from typing import Any

from environment import interpreters
from environment.interpreters import Interpreter
from environment.pins import canonical, is_ros, merge
from environment.places import LOCK_FILE

ROS_SECTION = '# --- ROS 2 Jazzy from PyPI'
OTHER_SECTION = '# --- everything else'
HEADER = """\
# Exact versions of everything in the virtual environment, for CPython 3.10 to 3.13 on Linux
# x86_64. Written by `python -m environment lock` from requirements.in; do not edit by hand.
#
# Install with `pip install --no-deps -r requirements.lock`: the list is complete, and two packages
# are left out on purpose. rosidl_parser asks for lark-parser, an old name under which lark was
# published; both own the folder site-packages/lark, and which one wins would depend on the order
# of installation. rosidl_parser works with lark 1.x (the apt installation of Jazzy uses 1.1.9), so
# only lark is installed. rfc3987-syntax, an option of jsonschema for addresses in other alphabets,
# compiles a grammar in every process that imports nbformat: 2.4 of 2.6 s. Without it, jsonschema
# accepts any such address.
"""
RESOLVED = '#\n# Resolved with CPython '
LEFT_OUT = {'lark-parser', 'rfc3987-syntax'}


def pins_of_report(report: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, str]]:
    """
    Return what `pip install --report` would install.

    :returns: name -> version, and requirement (`name==version`) -> SHA-256 of the file
    """
    pins, digests = {}, {}
    for item in report['install']:
        name, version = canonical(item['metadata']['name']), item['metadata']['version']
        if name not in LEFT_OUT:
            pins[name] = version
            file = item['download_info']['archive_info']
            digests[f'{name}=={version}'] = file['hashes']['sha256']
    return pins, digests


def with_digests(lines: Iterable[str], digests: Iterable[Mapping[str, str]]) -> list[str]:
    """Return sorted requirement lines with the digests of their files, found by each Python."""
    found: dict[str, set[str]] = {}
    for requirement, digest in (item for one in digests for item in one.items()):
        found.setdefault(requirement, set()).add(digest)
    return [
        line + ''.join(f' --hash=sha256:{one}' for one in sorted(found[line.partition(' ;')[0]]))
        for line in lines
    ]


def render(lines: Sequence[str], releases: Sequence[str]) -> str:
    """Return the text of the lock file; ``releases`` are the Pythons that resolved its lines."""
    ros = [line for line in lines if is_ros(line.split('==')[0])]
    other = [line for line in lines if line not in ros]
    head = HEADER + RESOLVED + ', '.join(releases)
    return '\n'.join([head, '', ROS_SECTION, *ros, '', OTHER_SECTION, *other, ''])


def resolve(python: str) -> tuple[dict[str, str], dict[str, str]]:
    """Resolve requirements.in in a temporary venv; return what :func:`pins_of_report` returns."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([python, '-m', 'venv', folder], check=True)
        report = Path(folder) / 'report.json'
        options = ['--quiet', '--dry-run', '--ignore-installed', '--no-input']
        options += ['--report', str(report), '-r', str(LOCK_FILE.with_suffix('.in'))]
        subprocess.run([f'{folder}/bin/python', '-m', 'pip', 'install', *options], check=True)
        return pins_of_report(json.loads(report.read_text(encoding='utf-8')))


def write_lock(environ: Mapping[str, str]) -> int:
    """Resolve with each supported Python and write the lock; return 1 if one is not installed."""
    paths = dict.fromkeys(interpreters.candidates(environ))
    found = [item for path in paths if (item := interpreters.probe(path, environ))]
    chosen = oldest_of_each([item for item in found if item.supported and item.complete])
    missing = set(interpreters.PREFERRED) - {item.version for item in chosen}
    if missing:
        print(f'lock: needs Python {", ".join(sorted(missing))}. Try: install it', file=sys.stderr)
        return 1
    pins, digests = {}, []
    for item in chosen:
        print(f'resolving with Python {item.release} ...', flush=True)
        pins[item.version], files = resolve(item.path)
        digests.append(files)
    text = render(with_digests(merge(pins), digests), [item.release for item in chosen])
    LOCK_FILE.write_text(text, encoding='utf-8')
    print(f'{LOCK_FILE}: written')
    return 0


def oldest_of_each(found: Iterable[Interpreter]) -> list[Interpreter]:
    """
    Return the oldest release of each version, sorted.

    Some packages require a patch release (3.11.5) that a distribution does not have (Debian 12 has
    3.11.2). Newer releases can install what the oldest one resolves.
    """
    newest_first = sorted(found, key=lambda item: item.numbers, reverse=True)
    oldest = {item.version: item for item in newest_first}
    return sorted(oldest.values(), key=lambda item: item.numbers)
