"""
Hostile programs get what their honest part deserves, and nothing leaves the sandbox.

Each file beside this one says in its docstring what it tries, the points it deserves, and the flag
an instructor must see where there is one.  All of them run once, side by side; every property is
then a test of its own.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
import os
from pathlib import Path
import re

import pytest

from autograder import exams
from autograder.examine import examine
from autograder.recording import Recording
from autograder.report import write_reports
from autograder.results import SubmissionResult
from autograder.sandbox import strongest

pytestmark = [pytest.mark.attacks, pytest.mark.ros, pytest.mark.slow]

FOLDER = Path(__file__).parent
ATTACKS = sorted(FOLDER.glob('temperature_*/*.py'))
CANARY = 'CANARY-7f3a9c'
SLEEPER = b'86397'


def names(path: Path) -> str:
    """Return a test id."""
    return path.stem


@pytest.fixture(scope='session')
def graded(tmp_path_factory):
    """Run every attack and return results and recordings by file."""
    kept = tmp_path_factory.mktemp('recordings')
    # A grader with a secret in its environment and a file beside it, to be looked for.
    secrets = tmp_path_factory.mktemp('hidden')
    (secrets / 'gradebook.json').write_text(f'{{"{CANARY}": 1}}', encoding='utf-8')
    os.environ['COURSE_SECRET_CANARY'] = CANARY
    sandbox = strongest()

    def run(path: Path):
        exam = exams.load(path.parent.name)
        folder = kept / path.stem
        files = {exam.requires[0]: path.read_text(encoding='utf-8')}
        result = examine(exam, files, sandbox=sandbox, recordings=folder)
        return result, Recording.load(next(folder.rglob('*.jsonl')))

    with ThreadPoolExecutor(3) as pool:
        return dict(zip(ATTACKS, pool.map(run, ATTACKS)))


def deserved(path: Path) -> tuple[float, bool]:
    """Return the points in the docstring, and whether they are only an upper bound."""
    found = re.search(r'^Deserves: (\d+)( at most)?$', path.read_text(encoding='utf-8'), re.M)
    assert found, f'{path}: expected a line "Deserves: N" in the docstring'
    return float(found[1]), bool(found[2])


@pytest.mark.parametrize('path', ATTACKS, ids=names)
def test_attack_gains_nothing(graded, path):
    """The score is what the honest part of the program deserves."""
    points, at_most = deserved(path)
    result, _ = graded[path]

    if at_most:
        assert result.points <= points
    else:
        assert result.points == points


@pytest.mark.parametrize('path', ATTACKS, ids=names)
def test_attack_finds_and_reaches_nothing(graded, path):
    """What the program itself reports about its loot is nothing."""
    _, recording = graded[path]
    text = '\n'.join(recording.lines())

    assert CANARY not in text
    for word in ('FOUND', 'WROTE', 'ESCAPED', 'REACHED'):
        assert word not in str(recording.process['stdout'])


@pytest.mark.parametrize('path', ATTACKS, ids=names)
def test_attack_that_names_a_flag_is_flagged(graded, path):
    """The instructor sees what was noticed."""
    wanted = re.findall(r'^Flag: (.+)$', path.read_text(encoding='utf-8'), re.M)
    result, _ = graded[path]

    for flag in wanted:
        assert any(flag in seen for seen in result.flags), result.flags


def test_no_process_is_left_behind(graded):
    """The daemon died with its sandbox."""
    left = []
    for folder in Path('/proc').glob('[0-9]*'):
        try:
            if SLEEPER in (folder / 'cmdline').read_bytes():
                left.append(folder.name)
        except OSError:
            continue

    assert left == []


def test_hostile_text_is_harmless_in_the_report(graded, tmp_path):
    """Markup from a submission is text in the page, and control characters are gone."""
    path = FOLDER / 'temperature_publisher' / 'hostile_text.py'
    result, _ = graded[path]
    submission = SubmissionResult('s', '07_temperature_monitor', (result,))
    write_reports(tmp_path, '07_temperature_monitor', [submission])
    page = ''.join(file.read_text(encoding='utf-8') for file in tmp_path.rglob('*.html'))

    assert '<script>alert' not in page
    assert '&lt;script&gt;' in page
    assert '\x1b' not in page
