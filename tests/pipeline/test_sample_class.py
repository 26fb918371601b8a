"""
Grade the bundled class with real runs: every verdict and cause is the expected one.

If docs/agreement.md was generated from the current files, every sample has been run, and only some
run again here.  Otherwise, in a course without that table, and if the variable FRESH is set, all
samples run.
"""

from collections.abc import Iterator
from functools import cache
import os
from pathlib import Path
import tempfile

import pytest

from autograder.authoring import sample_class
from autograder.authoring.sample_class import expected_of
from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.grading.pipeline import grade_class, grading_engine, load_lesson
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import ExamResult, SubmissionResult
from autograder.submission.inbox import Submission
from tests.judgement import agreement
from tests.judgement.properties import moved_by_text, revealed_inputs, unreadable
from tests.judgement.references import exercises
from tests.judgement.samples import counted, expected_verdicts, samples, UNTOUCHED, verdicts_of
from tests.pipeline.test_recording_schema import invalid_lines

LAYOUT = Layout.here()
_FOLDER = tempfile.TemporaryDirectory(prefix='class-')  # removed when Python ends
WORKING = Layout(Path(_FOLDER.name))
EXAMINED = [name for name in LAYOUT.assignments() if catalog.for_assignment(name)]
EVERY = 1 if os.environ.get('FRESH') else 10
"""The test runs one sample in this many, if all have been run for the table."""

# The first test of a lesson waits for all of its samples.
pytestmark = [
    pytest.mark.pipeline,
    pytest.mark.slow,
    pytest.mark.ros,
    pytest.mark.timeout(1800),
]
lessons = pytest.mark.parametrize('assignment', EXAMINED)


def folders(assignment: str) -> list[Path]:
    """Return all samples of a lesson, by name."""
    return list(sample_class.samples(LAYOUT, assignment, everything=True))


@cache
def graded(assignment: str) -> dict[str, SubmissionResult]:
    """Return the results of a lesson's samples by name, from one run of them all."""
    engine = grading_engine(WORKING)
    lesson = load_lesson(LAYOUT, assignment, engine)
    late = {exam.name for exam in lesson.exams} & set(agreement.late())
    class_ = [
        Submission(path.name, path, sample_class.compose(LAYOUT, assignment, path))
        for number, path in enumerate(folders(assignment))
        if late or number % EVERY == 0 or path.name == UNTOUCHED
    ]
    # More jobs than processors, because a run often only waits for a sleeping program.
    done = grade_class(class_, lesson, engine, jobs=4)
    return {one.result.student: one.result for one in done}


def judged_exams(assignment: str) -> Iterator[tuple[str, Exam, ExamResult]]:
    """Yield each exam of each graded sample, with the sample's name."""
    exams = {exam.name: exam for exam in catalog.for_assignment(assignment)}
    for name, submission in graded(assignment).items():
        for result in submission.exams:
            yield name, exams[result.exam], result


def recording_of(result: ExamResult) -> Recording:
    """Return the recording of an exam that was run."""
    return Recording.load(WORKING.recordings / result.exam / result.recording)


def seen(result: SubmissionResult) -> str:
    """Return how the runs of a submission began and ended, to help find the cause of a failure."""
    texts = [recording_of(one).to_bytes().decode() for one in result.exams if one.recording]
    return '\n'.join(
        text if len(text) < 4000 else f'{text[:2000]}\n...\n{text[-2000:]}' for text in texts
    )


@lessons
def test_the_class_is_large_enough(assignment):
    """Each lesson has correct answers in several styles, mistakes and an untouched release."""
    names = [path.name for path in folders(assignment)]
    outcomes = [name.partition('__')[0] for name in names]

    assert set(outcomes) <= {'pass', 'fail', 'error', 'zero'}
    assert outcomes.count('pass') >= 3
    assert outcomes.count('fail') >= 1
    assert UNTOUCHED in names


def test_the_class_has_every_kind_of_outcome():
    """Some samples of the course are notebooks that are broken as a whole."""
    outcomes = {path.name.partition('__')[0] for name in EXAMINED for path in folders(name)}

    assert outcomes == {'pass', 'fail', 'error', 'zero'}


def test_only_the_file_of_expectations_at_the_top_is_skipped(tmp_path):
    """Another file of this name is a mistake, like any file that is no answer."""
    (tmp_path / 'inner').mkdir()
    for name in ('expected.json', 'inner/expected.json'):
        (tmp_path / name).write_text('{}')

    with pytest.raises(GraderError, match=r'no such answer: inner/expected\.json'):
        sample_class.compose(LAYOUT, EXAMINED[0], tmp_path)


def test_an_answer_without_a_cell_is_a_mistake(tmp_path):
    (tmp_path / 'expected.json').write_text('{"answers": {"q99": "\'a\'"}}')

    with pytest.raises(GraderError, match='no such answer: q99'):
        sample_class.compose(LAYOUT, EXAMINED[0], tmp_path)


@pytest.mark.parametrize('exercise', exercises(), ids=lambda one: one.name)
def test_each_exercise_has_many_right_and_many_wrong_answers(exercise):
    """Styles and beginners' mistakes count; stubs and copies of the reference do not."""
    assert len(counted(samples(), exercise, right=True)) >= 12
    assert len(counted(samples(), exercise, right=False)) >= 12


@lessons
def test_verdicts_and_causes_and_points_are_those_expected(assignment):
    """Every check of every exam has the result in ``expected.json``."""
    wrong = {}
    for path in (one for one in folders(assignment) if one.name in graded(assignment)):
        result, expected = graded(assignment)[path.name], expected_of(path)
        got = {one.exam: (round(one.points, 3), verdicts_of(one)) for one in result.exams}
        wanted = {
            exam.name: (
                expected['points'][exam.name],
                expected_verdicts(exam, expected['failed'].get(exam.name, {}), got[exam.name][1]),
            )
            for exam in catalog.for_assignment(assignment)
        }
        if got != wanted or result.fault:
            wrong[path.name] = result.fault, got, wanted, seen(result)

    assert wrong == {}
    assert len(graded(assignment)) >= len(folders(assignment)) / EVERY


@lessons
def test_name_of_a_sample_says_whether_it_is_right(assignment):
    """Samples named ``pass`` have full points; the others fail a check and have fewer."""
    full = sum(exam.max_points for exam in catalog.for_assignment(assignment))
    for path in folders(assignment):
        expected, right = expected_of(path), path.name.startswith('pass__')

        assert (sum(expected['points'].values()) == full) == right, path
        assert any(expected['failed'].values()) != right, path


@lessons
def test_every_failing_text_is_short_and_tells_nothing_that_was_drawn(assignment):
    """A text has at most twelve lines, and no drawn value that a student could hard-code."""
    wrong = [
        (name, exam.name, line)
        for name, exam, result in judged_exams(assignment)
        for line in (*unreadable(result), *revealed_inputs(exam, result))
    ]

    assert wrong == []


@lessons
def test_what_a_program_says_moves_no_points_and_how_it_says_it_no_cause(assignment):
    """Each recording is judged again, with empty and with rewritten code."""
    results = {(name, exam.name): result for name, exam, result in judged_exams(assignment)}
    moved, examined = [], set()
    for sample in samples():
        exam = sample.exercise.exam
        result = results.get((sample.name, exam.name))
        if exam.assignment == assignment and result and result.recording:
            examined.add(exam.name)
            lines = moved_by_text(exam, sample.files, recording_of(result))
            moved += [(sample.name, exam.name, line) for line in lines]

    assert moved == []
    assert examined == programs(assignment)


@lessons
def test_every_line_of_a_recording_is_valid(assignment):
    """The test checks the last sample of each exam whose program was run."""
    run = {exam.name: one for _, exam, one in judged_exams(assignment) if one.recording}

    assert set(run) == programs(assignment)
    assert [line for one in run.values() for line in invalid_lines(recording_of(one))] == []


def programs(assignment: str) -> set[str]:
    """Return the exams of a lesson that run a program."""
    return {exam.name for exam in catalog.for_assignment(assignment) if exam.scenario.program}
