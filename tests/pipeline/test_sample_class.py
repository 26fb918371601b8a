"""The bundled class, graded for real: every verdict and its cause are the ones expected."""

from __future__ import annotations

from functools import cache
from pathlib import Path
import tempfile

import pytest

from autograder.authoring import sample_class
from autograder.exam import catalog
from autograder.explaining.feedback import check_lines, MOST_LINES, titles_of, WIDTH
from autograder.grading.examine import judged
from autograder.grading.pipeline import grade_class, grading_engine, load_lesson
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import SubmissionResult, Verdict
from autograder.submission.inbox import Submission
from tests.judgement.drawn_inputs import texts_of, told_of
from tests.judgement.kept import place_of, recorded
from tests.judgement.references import exercises
from tests.judgement.rewritten import blanked, commented, rewritten
from tests.judgement.samples import counted, expected_verdicts, samples, verdicts_of

LAYOUT = Layout.here()
_FOLDER = tempfile.TemporaryDirectory(prefix='class-')  # removed when Python ends
WORKING = Layout(Path(_FOLDER.name))
EXAMINED = [name for name in LAYOUT.assignments() if catalog.for_assignment(name)]
SAMPLES = [
    pytest.param(assignment, path.name, id=f'{assignment}-{path.name}')
    for assignment in EXAMINED
    for path in sample_class.samples(LAYOUT, assignment, everything=True)
]

# The first test of a lesson waits for all of its samples.
pytestmark = [
    pytest.mark.pipeline,
    pytest.mark.slow,
    pytest.mark.ros,
    pytest.mark.timeout(1800),
]


@cache
def graded(assignment: str) -> dict[str, SubmissionResult]:
    """Return the results of a lesson's samples by name, from one run of them all."""
    engine = grading_engine(WORKING)
    lesson = load_lesson(LAYOUT, assignment, engine)
    class_ = [
        Submission(path.name, path, sample_class.compose(LAYOUT, assignment, path))
        for path in sample_class.samples(LAYOUT, assignment, everything=True)
    ]
    # More than there are processors: much of the time, a program is watched and sleeps.
    done = grade_class(class_, lesson, engine, jobs=4)
    return {one.result.student: one.result for one in done}


def seen(result: SubmissionResult) -> str:
    """Return how the runs of a submission began and ended, for whom has to find out."""
    kept = [one for one in result.exams if one.recording]
    texts = [(WORKING.recordings / one.exam / one.recording).read_text('utf-8') for one in kept]
    return '\n'.join(
        text if len(text) < 4000 else f'{text[:2000]}\n...\n{text[-2000:]}' for text in texts
    )


@pytest.mark.parametrize('assignment', EXAMINED)
def test_the_class_is_large_enough(assignment):
    """Each lesson has right answers of several styles, mistakes and an untouched release."""
    names = [path.name for path in sample_class.samples(LAYOUT, assignment, everything=True)]
    outcomes = [name.partition('__')[0] for name in names]

    assert set(outcomes) <= {'pass', 'fail', 'error', 'zero'}
    assert outcomes.count('pass') >= 3
    assert outcomes.count('fail') >= 1
    assert 'zero__untouched_stub' in names


def test_the_class_has_every_kind_of_outcome():
    """Somewhere in the course, a notebook as a whole is broken too."""
    outcomes = {parameters.values[1].partition('__')[0] for parameters in SAMPLES}

    assert outcomes == {'pass', 'fail', 'error', 'zero'}


@pytest.mark.parametrize('exercise', exercises(), ids=lambda one: one.name)
def test_each_exercise_has_many_right_and_many_wrong_answers(exercise):
    """Honest styles and beginners' mistakes; stubs and copies of the reference do not count."""
    assert len(counted(samples(), exercise, right=True)) >= 12
    assert len(counted(samples(), exercise, right=False)) >= 12


@pytest.mark.parametrize(('assignment', 'name'), SAMPLES)
def test_verdicts_and_causes_and_points_are_those_expected(assignment, name):
    """The folder's name says what happens."""
    result = graded(assignment)[name]
    expected = sample_class.expected_of(LAYOUT.sample_class / assignment / name)
    verdicts = {exam.exam: verdicts_of(exam) for exam in result.exams}
    wanted = {
        exam.name: expected_verdicts(exam, expected['failed'].get(exam.name, {}))
        for exam in catalog.for_assignment(assignment)
    }

    assert result.fault == ''
    assert verdicts == wanted, seen(result)
    assert {exam.exam: round(exam.points, 3) for exam in result.exams} == expected['points']
    if name.startswith('pass__'):
        assert result.points == result.max_points
    else:
        assert result.points < result.max_points
        assert any(
            Verdict.FAILED.value in one for exam in wanted.values() for one in exam.values()
        )


@pytest.mark.parametrize('assignment', EXAMINED)
def test_every_failing_text_is_short(assignment):
    """Twelve lines of a readable width, whatever was handed in."""
    for name, submission in graded(assignment).items():
        for exam in submission.exams:
            for check in exam.checks:
                lines = check_lines(check, titles_of(exam))
                assert len(lines) <= MOST_LINES, (name, lines)
                assert max(map(len, lines)) <= WIDTH, (name, lines)
                if check.verdict is not Verdict.PASSED:
                    assert len(lines) > 1, (name, lines)


@pytest.mark.parametrize('assignment', EXAMINED)
def test_no_failing_text_tells_what_was_drawn(assignment):
    """A student who learns the inputs could hard-code them and hand in again."""
    drawn = {exam.name: exam for exam in catalog.for_assignment(assignment)}
    for name, submission in graded(assignment).items():
        for result in submission.exams:
            for check in result.failed:
                assert told_of(drawn[result.exam], texts_of(check)) == [], (name, check)


@pytest.mark.parametrize('assignment', EXAMINED)
def test_what_a_program_says_moves_no_points_and_how_it_says_it_no_cause(assignment):
    """Each recording is judged again, with nothing and with another text beside it."""
    assert graded(assignment)
    exams = {exam.name: exam for exam in catalog.for_assignment(assignment)}
    known = recorded(exams, WORKING.recordings)
    moved, count = [], 0
    for sample in (one for one in samples() if one.exercise.name in exams):
        exam, files = sample.exercise.exam, sample.files
        path = known.get(place_of(exam, files))
        if path is None:
            continue
        recording = Recording.load(path)
        # The lines that it names are those of the text that has run.
        events = [{**event, 'line': None} for event in recording.events]
        recording = Recording(recording.header, events)
        ways = [commented]
        if 'Traceback' not in str(recording.process.get('stderr', '')):
            ways.append(rewritten)
        due, silent = (judged(exam, text, recording) for text in (files, blanked(files)))
        count += 1
        moved += [
            (sample.name, check.check)
            for check, other in zip(due.checks, silent.checks)
            if check.points != other.points
        ]
        for way in ways:
            others = judged(exam, way(files), recording).checks
            moved += [
                (sample.name, way.__name__, check.check, check.cause_id, other.cause_id)
                for check, other in zip(due.checks, others)
                if (check.points, check.cause_id) != (other.points, other.cause_id)
            ]

    assert moved == []
    assert count >= sum(bool(exam.scenario.program) for exam in exams.values())
