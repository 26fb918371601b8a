"""Programs that a warm process runs behave as if Python had run them."""

import os
from pathlib import Path
import subprocess
import sys
from typing import Any

import pytest

from autograder.runs.observe import HERE

INSIDE = str(HERE / 'inside')
# The process that forks must not be pytest's own.
BESIDE = f"""
import sys
sys.path.insert(0, {INSIDE!r})
from functools import partial
from pathlib import Path
import warm_python
listening, names = warm_python.listen(Path(sys.argv[1]))
import os, subprocess
def build():
    done = subprocess.run([sys.executable, '-SE', {INSIDE + '/hand_over.py'!r}, *sys.argv[2:]],
                          env={{**os.environ, **names, 'ASKED': 'yes'}})
    return done.returncode
sys.exit(warm_python.run_beside(build, listening))
"""
# ``sys.orig_argv`` tells a process that Python started for the program from a copy of another one.
PROGRAMS = {
    'says what it is': (
        'import os, sys\n'
        'print(sys.argv, os.getcwd(), os.environ["ASKED"], __name__, sys.path[0])\n'
        'print("and complains", file=sys.stderr)\n'
        'import beside_it\n',
        0,
    ),
    'ends with a number': ('import sys; sys.exit(7)', 7),
    'ends with a text': ('import sys; sys.exit("a text")', 1),
    'raises': ('print("before", flush=True); {}["key"]', 1),
    'reads': ('print(input())', 0),
}


def ran(folder: Path, *words: str, place: Path | None = None) -> Any:
    """Run a program beside a warm process and return what it said, paths of ours left out."""
    return subprocess.run(
        [sys.executable, '-c', BESIDE, str(place or folder), *words],
        cwd=folder,
        input='a line\n',
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a module to import."""
    (tmp_path / 'beside_it.py').write_text('print("imported")\n')
    return tmp_path


@pytest.mark.parametrize(('text', 'code'), PROGRAMS.values(), ids=PROGRAMS.keys())
def test_a_program_that_is_handed_over_behaves_as_in_python(folder, text, code):
    """Output, complaints, input, arguments, folder, environment and exit code are the same."""
    (folder / 'setup.py').write_text(text)
    env = {**os.environ, 'ASKED': 'yes'}
    expected = subprocess.run(
        [sys.executable, 'setup.py', 'one', 'two  three', ''],
        cwd=folder,
        env=env,
        input='a line\n',
        capture_output=True,
        text=True,
        check=False,
    )

    done = ran(folder, 'setup.py', 'one', 'two  three', '')

    assert (done.returncode, done.stdout) == (expected.returncode, expected.stdout)
    assert done.returncode == code
    assert done.stderr.splitlines()[-1:] == expected.stderr.splitlines()[-1:]


def test_only_known_programs_are_handed_over(folder):
    """Another one gets a Python of its own, with that Python's own modules."""
    text = 'import sys; print("warm" if "warm_python" in sys.modules else "own")\n'
    (folder / 'setup.py').write_text(text)
    (folder / 'other.py').write_text(text)

    assert ran(folder, 'setup.py').stdout == 'warm\n'
    assert ran(folder, 'other.py').stdout == 'own\n'
    assert ran(folder, '-c', text).stdout == 'own\n'


def test_a_program_that_is_killed_is_a_failure(folder):
    """The one who waits for it is told so, and the warm process goes on."""
    (folder / 'setup.py').write_text('import os, signal; os.kill(os.getpid(), signal.SIGKILL)\n')

    assert ran(folder, 'setup.py').returncode == 1


def test_a_folder_too_deep_for_a_socket_costs_time_only(folder):
    """Every program is run by Python then."""
    text = 'import sys; print("warm" if "warm_python" in sys.modules else "own")\n'
    (folder / 'setup.py').write_text(text)
    deep = folder.joinpath(*['deeper' * 10] * 2)
    deep.mkdir(parents=True)

    assert ran(folder, 'setup.py', place=deep).stdout == 'own\n'
