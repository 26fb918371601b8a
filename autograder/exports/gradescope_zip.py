"""
Pack the course as an autograder for Gradescope's container, with the same exams.

``setup.sh`` and ``run_autograder`` are at the root of the zip; the rest is the course without its
submissions.  The zip includes the course secret, so that hidden inputs are the same on Gradescope.
It must therefore be kept as secret as the hidden exams.  The README in the zip describes what the
container must allow: without user namespaces only weaker isolation works, and it is used only if
``--allow-weak`` names it.
"""

from __future__ import annotations

from collections.abc import Iterator
import io
import json
from pathlib import Path
import stat
import zipfile

from autograder.errors import GraderError
from autograder.exam.inputs import course_secret
from autograder.exports.gradescope import VISIBILITIES
from autograder.layout import Layout
from autograder.sandboxes.isolation import MODES
from environment.places import PROJECT

HERE = Path(__file__).parent / 'gradescope_files'
EXECUTABLE = ('setup.sh', 'run_autograder')
SETTINGS = 'gradescope.json'
ENGINE = ('autograder', 'drawing', 'environment', 'roslab', 'pyproject.toml')
"""Files and folders of this project that grading needs, in addition to the course's own files."""
LEFT_OUT = {'_work', '__pycache__', '.ipynb_checkpoints', 'ros_ws', '.mypy_cache', '.ruff_cache'}
MADE = (2024, 1, 1, 0, 0, 0)
"""Date of every entry of the zip; it is fixed, so that the same course gives the same bytes."""


def autograder_zip(
    layout: Layout, assignment: str, visibility: str = VISIBILITIES[0], allow_weak: str = ''
) -> bytes:
    """
    Return the zip file as bytes.

    :param assignment: full name of the assignment
    :param visibility: see :mod:`autograder.exports.gradescope`
    :param allow_weak: weakest isolation mode to accept in the container, see
        :mod:`autograder.sandboxes.isolation`; empty for full isolation only
    :raises GraderError: if hidden exams must not run with this mode, or this copy of the course
        has no hidden exams
    """
    if allow_weak and not MODES[allow_weak].keeps_secrets:
        raise GraderError(
            f'--allow-weak {allow_weak}: hidden exams never run with this isolation, so '
            'there would be no grades.'
        )
    if not (layout.exams / 'hidden').is_dir():
        raise GraderError(
            'The copy of the course for students has no hidden exams.',
            "Try: run this in the instructors' copy",
        )
    settings = {'assignment': assignment, 'visibility': visibility, 'allow_weak': allow_weak}
    made = io.BytesIO()
    with zipfile.ZipFile(made, 'w', zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(HERE.iterdir()):
            if path.is_file():
                _add(archive, path.name, path.read_bytes(), path.name in EXECUTABLE)
        _add(archive, SETTINGS, (json.dumps(settings, indent=1) + '\n').encode())
        for name, path in course_files(layout):
            _add(archive, name, path.read_bytes(), bool(path.stat().st_mode & stat.S_IXUSR))
        _add(archive, str(layout.secret.relative_to(layout.root)), course_secret(), mode=0o600)
    return made.getvalue()


def course_files(layout: Layout) -> Iterator[tuple[str, Path]]:
    """Yield the files that grading needs, each with its name in the zip, in a fixed order."""
    exams = layout.exams.relative_to(layout.root).parts[0]
    own = {'course.toml', 'nbgrader_config.py', 'notebooks', 'solutions', exams}
    own |= {layout.facts.package} - {''}
    parts = {**dict.fromkeys(ENGINE, PROJECT), **dict.fromkeys(own, layout.root)}
    for part, root in sorted(parts.items()):
        start = root / part
        for path in [start] if start.is_file() else sorted(start.rglob('*')):
            inside = path.relative_to(root)
            hidden = any(part in LEFT_OUT or part.startswith('.') for part in inside.parts)
            if not hidden and path.is_file() and not path.is_symlink():
                yield inside.as_posix(), path


def _add(
    archive: zipfile.ZipFile, name: str, data: bytes, executable: bool = False, mode: int = 0o644
) -> None:
    """Add a file with its permissions, in the format of Info-ZIP."""
    entry = zipfile.ZipInfo(name, MADE)
    entry.create_system = 3  # Unix, where the upper half of external_attr is st_mode.
    entry.external_attr = (stat.S_IFREG | (0o755 if executable else mode)) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, data)
