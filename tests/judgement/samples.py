"""
Read the sample submissions by exercise, with the expected result of every check.

``expected.json`` of a submission lists its points and the failing checks with their causes.
Every other check passes; a check that needs a failing one may also not be run.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from autograder.authoring import sample_class
from autograder.authoring.sample_class import compose, expected_of, own_files
from autograder.exam.exam import Exam
from autograder.results import ExamResult, Verdict
from autograder.submission.notebook import Notebook, read_release
from autograder.submission.submission import answer_files, extract, open_submission
from tests.judgement.references import Exercise, exercises, LAYOUT

UNTOUCHED = 'zero__untouched_stub'
REFERENCE = 'pass__reference'


@dataclass(frozen=True)
class Sample:
    """
    The part of a submission that one exercise judges.

    :param own: whether it differs from the reference in this exercise
    :param files: the judged files, relative path to text
    :param failed: the checks that must fail, with the ids of their causes
    :param points: the expected points in this exercise
    """

    exercise: Exercise
    name: str
    about: str
    own: bool
    files: Mapping[str, str]
    failed: Mapping[str, str]
    points: float

    @property
    def counts(self) -> bool:
        """Return whether the sample answers this exercise and is neither a stub nor a copy."""
        return self.name != UNTOUCHED and (self.own or self.name == REFERENCE)


@cache
def samples() -> tuple[Sample, ...]:
    """Return every submission of every exercise, in the order of the course and by name."""
    assignments = dict.fromkeys(one.exam.assignment for one in exercises())
    return tuple(sample for assignment in assignments for sample in _of_lesson(assignment))


def _of_lesson(assignment: str) -> list[Sample]:
    release = read_release(LAYOUT.release(assignment))
    found = []
    for path in sample_class.samples(LAYOUT, assignment, everything=True):
        found += list(_of_submission(path, assignment, release))
    names = [one.name for one in exercises()]
    return sorted(found, key=lambda one: (names.index(one.exercise.name), one.name))


def _of_submission(path: Path, assignment: str, release: Notebook) -> Iterator[Sample]:
    """Yield the sample of each exercise of a lesson in a submission."""
    expected = expected_of(path)
    opened = open_submission(compose(LAYOUT, assignment, path), release, path.name)
    theirs = [one for one in exercises() if one.exam.assignment == assignment]
    files = extract(opened, [one.exam for one in theirs], release, path.name)
    cells = answer_files(release)
    for exercise in theirs:
        names = {*exercise.exam.cells, *(cells[name].path for name in exercise.exam.cells)}
        own = not names.isdisjoint({*own_files(path), *expected.get('answers', {})})
        failed = expected['failed'].get(exercise.name, {})
        about = str(expected.get('about', ''))
        yield Sample(
            exercise,
            path.name,
            about,
            own or bool(failed and expected.get('notebook')),
            files[exercise.name].files,
            failed,
            expected['points'][exercise.name],
        )


Verdicts = dict[str, tuple[str, str]]
"""The verdict of each check by its name, with the id of the cause if it fails."""


def expected_verdicts(exam: Exam, failed: Mapping[str, str], got: Verdicts) -> Verdicts:
    """
    Return the expected result of every check.

    :param failed: the checks that must fail, with the ids of their causes
    :param got: the actual results: a check that needs a failed one may pass or not be run
    """
    passed, not_run = (Verdict.PASSED.value, ''), (Verdict.NOT_RUN.value, '')
    found: Verdicts = {}
    missing = 'missing_file' in failed.values()  # no program ran, so no check did either
    for check in exam.checks:
        if check.name in failed:
            found[check.name] = Verdict.FAILED.value, failed[check.name]
        elif missing:
            found[check.name] = not_run
        elif all(found[need] == passed for need in check.needs) or got[check.name] == passed:
            found[check.name] = passed
        else:
            found[check.name] = not_run
    return found


def verdicts_of(result: ExamResult) -> Verdicts:
    """Return the result of every check: its verdict, and the id of its cause."""
    return {one.check: (one.verdict.value, one.cause_id) for one in result.checks}


def differences(sample: Sample, result: ExamResult) -> list[str]:
    """Return one line for each result that differs from the expected one: points and checks."""
    got = verdicts_of(result)
    wanted = expected_verdicts(sample.exercise.exam, sample.failed, got)
    points = round(result.points, 3)
    other = (
        [] if points == sample.points else [f'expected {sample.points:g} points, got {points:g}']
    )
    checks = [
        f'{name}: expected {" ".join(wanted[name]).strip()}, got {" ".join(got[name]).strip()}'
        for name in wanted
        if got[name] != wanted[name]
    ]
    return [*other, *checks]


def counted(found: Sequence[Sample], exercise: Exercise, right: bool) -> list[Sample]:
    """Return the submissions of an exercise that are right, or those that are wrong."""
    return [
        one
        for one in found
        if one.exercise is exercise and one.counts and bool(one.failed) != right
    ]
