"""Find a suitable Python for the course: CPython 3.10 to 3.13 with venv and headers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import glob
import json
from pathlib import Path
import shutil
import subprocess

# Most preferred first: 3.12 is the version of Ubuntu 24.04 and thus of Jazzy; 3.11 is also tested.
PREFERRED = ('3.12', '3.11', '3.13', '3.10')
TESTED = PREFERRED[:2]
# Distributions build Python with profile-guided optimisation: grading takes a fifth less CPU time
# than with a Python that pyenv builds by default.
DISTRIBUTION = '/usr'

# Runs in the candidate. The Python of a venv describes the interpreter that created it.
_PROBE = """
import importlib.util, json, os, platform, sys, sysconfig
print(json.dumps({
    'path': getattr(sys, '_base_executable', None) or sys.executable,
    'release': '%d.%d.%d' % sys.version_info[:3],
    'implementation': sys.implementation.name,
    'base_prefix': sys.base_prefix,
    'has_venv': all(importlib.util.find_spec(n) for n in ('venv', 'ensurepip')),
    'has_headers': os.path.exists(os.path.join(sysconfig.get_path('include'), 'Python.h')),
    'platform': sysconfig.get_platform(),
    'libc': list(platform.libc_ver()),
}))
"""


@dataclass(frozen=True)
class Interpreter:
    """
    The facts that a candidate interpreter reports about itself.

    :param release: '3.12.1'
    :param implementation: 'cpython'
    :param has_venv: whether it can create a virtual environment with pip
    :param has_headers: whether Python.h exists, which generated message code includes
    :param platform: such as 'linux-x86_64'
    :param libc: name and version of the C library
    """

    path: str
    release: str
    implementation: str
    base_prefix: str
    has_venv: bool
    has_headers: bool
    platform: str
    libc: tuple[str, str]

    @property
    def version(self) -> str:
        """The version without the patch release: '3.12'."""
        return '.'.join(self.release.split('.')[:2])

    @property
    def numbers(self) -> tuple[int, ...]:
        """The release as a tuple of numbers, for comparisons."""
        return tuple(int(part) for part in self.release.split('.'))

    @property
    def supported(self) -> bool:
        """Return whether the lock has pins for this version."""
        return self.implementation == 'cpython' and self.version in PREFERRED

    @property
    def preference(self) -> tuple[bool, bool, bool, int]:
        """Sort key, best first: complete, tested, from the distribution, preferred version."""
        return (
            not self.complete,
            self.version not in TESTED,
            self.base_prefix != DISTRIBUTION,
            PREFERRED.index(self.version),
        )

    @property
    def complete(self) -> bool:
        """Return whether it has everything that the set-up needs."""
        return self.has_venv and self.has_headers

    def lacking(self) -> str:
        """Return what is missing, as text; '' if nothing is."""
        words = [] if self.has_venv else ['venv']
        words += [] if self.has_headers else ['headers (Python.h)']
        return ' and '.join(words)


def probe(path: str, environ: Mapping[str, str]) -> Interpreter | None:
    """Return the facts of an interpreter, None if it does not run, such as a broken pyenv shim."""
    clean = {k: v for k, v in environ.items() if not k.startswith('PYTHON')}
    try:
        done = subprocess.run(
            [path, '-I', '-S', '-c', _PROBE],
            env=clean,
            capture_output=True,
            text=True,
            timeout=30,
            stdin=subprocess.DEVNULL,
        )
        answer = json.loads(done.stdout)
        return Interpreter(**{**answer, 'libc': tuple(answer['libc'])})
    except (OSError, ValueError, TypeError, KeyError, subprocess.TimeoutExpired):
        return None


def candidates(environ: Mapping[str, str]) -> Iterator[str]:
    """Yield commands and files to try, the preferred versions first."""
    path = environ.get('PATH')
    pyenv = Path(environ.get('PYENV_ROOT') or Path(environ.get('HOME', '/'), '.pyenv'))
    for version in PREFERRED:
        for folder in (path, '/usr/local/bin', '/usr/bin'):
            found = shutil.which(f'python{version}', path=folder)
            if found:
                yield found
        # glob, unlike Path.glob, skips folders that this user may not read: after `runuser -u` or
        # `su`, the variables still name the pyenv folder of the previous user.
        homes = glob.glob(f'{glob.escape(str(pyenv))}/versions/{version}*')
        for home in sorted(homes, reverse=True):
            yield f'{home}/bin/python{version}'
    for name in ('python3', 'python'):
        found = shutil.which(name, path=path)
        if found:
            yield found


def choose(found: Sequence[Interpreter]) -> Interpreter | None:
    """Return the best interpreter by :attr:`Interpreter.preference`, or None."""
    supported = [item for item in found if item.supported]
    return min(supported, key=lambda item: item.preference, default=None)


def find(environ: Mapping[str, str], request: str = '') -> Interpreter | None:
    """Find the Python for the venv: only the one that PYTHON=... requests, or else the best."""
    if request:
        asked = probe(shutil.which(request, path=environ.get('PATH')) or request, environ)
        return choose([asked]) if asked else None
    found: list[Interpreter] = []
    for path in dict.fromkeys(candidates(environ)):
        item = probe(path, environ)
        if item:
            found.append(item)
            if item.supported and not any(item.preference[:3]):
                break  # the remaining candidates have less preferred versions
    return choose(found)


def wheels_refusal(interpreter: Interpreter) -> str:
    """Return why the ROS 2 wheels cannot be used on this machine; '' if they can be."""
    name, version = interpreter.libc
    if interpreter.platform != 'linux-x86_64':
        return f'the ROS 2 wheels are for Linux on x86_64; this is {interpreter.platform}'
    numbers = tuple(int(part) for part in version.split('.') if part.isdigit())
    if name != 'glibc' or numbers < (2, 28):
        return f'the ROS 2 wheels need glibc 2.28 or newer; this is {name} {version}'.rstrip()
    return ''
