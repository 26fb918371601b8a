"""Only one grading run is active at a time, and leftovers of a killed run are removed."""

import os
from pathlib import Path
import subprocess
import sys

from collect_sources import laid
import pytest

from autograder.classroom.course_lock import lock_course
from autograder.errors import GraderError
from autograder.files import write_atomically
from autograder.layout import Layout

HOLDER = """
import sys
from pathlib import Path
from autograder.layout import Layout
from autograder.classroom.course_lock import lock_course
with lock_course(Layout(Path(sys.argv[1])), 'a grading'):
    print('held', flush=True)
    sys.stdin.read()
"""


def held(root):
    """Start a second process that holds the course's lock."""
    process = subprocess.Popen(
        [sys.executable, '-c', HOLDER, str(root)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b'held\n'
    return process


def create_leftover_files(layout):
    """Create one file that a killed run leaves, and two files of other programs; return all."""
    names = f'.results.json.{"0f" * 16}', '.hidden', 'class.html'
    folder = laid(layout.reports / '01_talker', dict.fromkeys(names, b''))
    return [folder / name for name in names]


def test_a_second_grading_names_the_first_one(tmp_path):
    layout = Layout(tmp_path)
    with held(tmp_path) as first:
        with pytest.raises(GraderError, match=f'a grading since .*, process {first.pid}'):
            with lock_course(layout, 'rejudge --write'):
                pass
        first.communicate()
    with lock_course(layout, 'rejudge --write'):
        assert f'process {os.getpid()}' in (layout.work / 'lock').read_text(encoding='utf-8')

    assert (layout.work / 'lock').read_bytes() == b''


def test_what_a_killed_grading_left_goes(tmp_path):
    """The next grading run removes the files, because the kernel has released the lock."""
    layout = Layout(tmp_path)
    with held(tmp_path) as first:
        half, *others = create_leftover_files(layout)
        first.kill()
        first.communicate()
    with lock_course(layout, 'a grading'):
        assert not half.exists()
        assert all(path.exists() for path in others)


def test_unfinished_file_of_a_running_process_is_kept(tmp_path, monkeypatch):
    """``run`` may save a recording while a grading run starts."""
    layout = Layout(tmp_path)
    path = layout.recordings / 'talker' / 'x.jsonl'
    rename = Path.replace

    def begin_to_grade(unfinished, target):
        layout.work.joinpath('lock').write_text('a grading that was killed', encoding='utf-8')
        with lock_course(layout, 'a grading'):
            pass
        return rename(unfinished, target)

    monkeypatch.setattr(Path, 'replace', begin_to_grade)
    write_atomically(path, b'whole')

    assert path.read_bytes() == b'whole'


def test_a_grading_that_ended_well_left_nothing_to_look_for(tmp_path):
    layout = Layout(tmp_path)
    with lock_course(layout, 'a grading'):
        pass
    half, *_ = create_leftover_files(layout)
    with lock_course(layout, 'a grading'):
        assert half.exists()
