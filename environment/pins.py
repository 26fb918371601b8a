"""
Read and merge exact pins: the lines of the lock file that apply to one Python.

The lock covers four Pythons; where they differ, lines have an environment marker. This module
understands only the markers that :func:`merge` writes, so it needs no packaging library.
"""

from collections.abc import Iterator, Mapping
import re

# These are ROS packages, too: NumPy must be the version with which a sourced ROS 2 was compiled.
ROS_NAMES = {'numpy'}

PIN = re.compile(
    r'^(?P<name>[A-Za-z0-9][A-Za-z0-9._-]*)==(?P<version>[A-Za-z0-9.!+_-]+)(?P<rest>\s*;.*?)??'
    r'(?P<digests>(?:\s+--hash=sha256:[0-9a-f]{64})*)$'
)
PYTHON = re.compile(r'python_version == "([\d.]+)"')


def canonical(name: str) -> str:
    """Return a project name in its normalised spelling, for comparisons."""
    return re.sub(r'[-_.]+', '-', name).lower()


def is_ros(name: str) -> bool:
    """Return whether a package is part of a sourced ROS 2 installation."""
    return canonical(name).startswith('ros-') or canonical(name) in ROS_NAMES


def pins_for(text: str, python: str, *, ros: bool = True) -> dict[str, str]:
    """
    Return the pins of the lock for one Python.

    :param python: version of the Python, such as '3.12'
    :param ros: False omits packages that are part of a sourced ROS 2 installation
    :returns: name -> version
    """
    lines = _lines_for(text, python, ros)
    return {canonical(match['name']): match['version'] for match in lines}


def requirements_for(text: str, python: str, *, ros: bool = True) -> list[str]:
    """Return the lines of :func:`pins_for`: one per pin, with the digests of its files."""
    lines = _lines_for(text, python, ros)
    return [f'{match["name"]}=={match["version"]}{match["digests"]}' for match in lines]


def _lines_for(text: str, python: str, ros: bool) -> Iterator[re.Match[str]]:
    for line in text.splitlines():
        match = PIN.match(line)
        if match and applies(match['rest'], python) and (ros or not is_ros(match['name'])):
            yield match


def applies(marker: str | None, python: str) -> bool:
    """Evaluate an environment marker written by :func:`merge`, which lists Pythons."""
    return not marker or python in PYTHON.findall(marker)


def merge(pins: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Merge the pins of several Pythons into sorted lines, with a marker where they differ."""
    lines = []
    for name in sorted({name for found in pins.values() for name in found}):
        versions: dict[str, list[str]] = {}
        for python, found in pins.items():
            if name in found:
                versions.setdefault(found[name], []).append(python)
        for version, used_by in versions.items():
            marker = ' or '.join(f'python_version == "{python}"' for python in used_by)
            everywhere = len(used_by) == len(pins)
            lines.append(f'{name}=={version}' + ('' if everywhere else f' ; {marker}'))
    return lines
