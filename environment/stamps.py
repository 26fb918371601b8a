"""
Determine which steps are up to date, from digests of their inputs.

A step's stamp is written after the step has succeeded, so a killed step has none and runs again.
The stamp of the entire set-up makes a second `make` immediate: comparing it starts no process.
"""

from collections.abc import Iterable, Mapping
import hashlib
import json
from pathlib import Path

from environment.pins import requirements_for
from environment.places import (
    CLOCK_SOURCES,
    LOCK_FILE,
    MESSAGES_FILE,
    Places,
    PROJECT,
    write_atomically,
)

# The build does not install these, so changes in them need no new build.
_SKIPPED = {'__pycache__', '.pytest_cache', '.ruff_cache', '.mypy_cache', 'test'}


def digest_of(*texts: str) -> str:
    """Return one digest of several strings; it depends on where each string ends."""
    sha = hashlib.sha256()
    for text in texts:
        data = text.encode()
        sha.update(b'%d:' % len(data) + data)
    return sha.hexdigest()


def files_below(folder: Path) -> list[Path]:
    """Return the source files of a folder, sorted, without caches and tests."""
    return sorted(
        path
        for path in folder.rglob('*')
        if path.is_file() and not _SKIPPED & set(path.relative_to(folder).parts)
    )


def clock_sources() -> list[Path]:
    """Return the C sources and headers of the virtual clock, sorted."""
    return [path for path in files_below(CLOCK_SOURCES) if path.suffix in ('.c', '.h')]


def digest_of_files(paths: Iterable[Path], root: Path = PROJECT) -> str:
    """Return one digest of the names and contents of files."""
    facts = ((path.relative_to(root), hashlib.sha256(path.read_bytes())) for path in paths)
    return digest_of(*(text for name, sha in facts for text in (str(name), sha.hexdigest())))


def package_digest(places: Places) -> str:
    """Return the digest of the course package's sources and of the code that builds it."""
    environment = PROJECT / 'environment'
    own = files_below(places.package) if places.package_name else []
    builds = [*files_below(environment / 'cmake'), environment / 'cmake_notes.py']
    return digest_of(digest_of_files(own, places.project), digest_of_files(builds))


def clock_digest() -> str:
    """Return the digest of the virtual clock's sources and of the code that builds it."""
    return digest_of_files([*clock_sources(), PROJECT / 'environment' / 'clock.py'])


def whole_digest(places: Places) -> str:
    """Return the digest of all inputs of a prepared environment."""
    own = digest_of_files(files_below(PROJECT / 'environment'))
    names = str(places.project), str(places.venv)
    return digest_of(*names, own, package_digest(places), clock_digest())


def packages_digest(python_version: str, kind: str) -> str:
    """Return the digest of the packages that pip installs: the pins for this Python only."""
    text = LOCK_FILE.read_text(encoding='utf-8')
    return digest_of(kind, *requirements_for(text, python_version, ros=kind == 'wheels'))


def messages_text() -> str:
    """Return the text of ``messages.txt``, empty if there is no such file."""
    try:
        return MESSAGES_FILE.read_text(encoding='utf-8')
    except FileNotFoundError:
        return ''


def ros_request(environ: Mapping[str, str]) -> str:
    """Return ROS_SOURCE or the sourced prefixes, '' if the shell requests no ROS 2."""
    if environ.get('ROS_SOURCE'):
        return environ['ROS_SOURCE']
    return environ.get('AMENT_PREFIX_PATH', '') if environ.get('ROS_DISTRO') == 'jazzy' else ''


def stamp_of(notes: Path, step: str) -> Path:
    """Return the file in :attr:`Places.notes` with the digest from the last success of a step."""
    return notes / f'{step}.stamp'


def is_stamped(notes: Path, step: str, digest: str) -> bool:
    """Return whether a step last succeeded with this digest."""
    try:
        return stamp_of(notes, step).read_text(encoding='utf-8') == digest
    except OSError:
        return False


def write_ready(
    places: Places, environ: Mapping[str, str], python_version: str, digest: str
) -> None:
    """Record what was prepared: the :func:`whole_digest`, and the requested ROS 2 and Python."""
    ready = {
        'digest': digest,
        'python_version': python_version,
        'python_request': environ.get('PYTHON', ''),
        'ros_request': ros_request(environ),
    }
    write_atomically(places.ready, json.dumps(ready, indent=1) + '\n')


def is_ready(places: Places, environ: Mapping[str, str]) -> bool:
    """
    Return whether the prepared environment is up to date and matches the user's request.

    A shell without a request (no PYTHON=, nothing sourced) accepts any prepared environment.
    """
    try:
        ready = json.loads(places.ready.read_text(encoding='utf-8'))
        return bool(
            ready['digest'] == whole_digest(places)
            and environ.get('PYTHON', '') in ('', ready['python_request'])
            and ros_request(environ) in ('', ready['ros_request'])
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False
