"""
Read the last results of a class.

Reports, statistics and exports use these results and run no program.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
import json
from pathlib import Path

from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.results import ExamResult, SubmissionResult
from autograder.sandboxes.isolation import MODES


@dataclass(frozen=True)
class ClassResults:
    """The last results of one assignment, in the order of the grading."""

    assignment: str
    results: tuple[SubmissionResult, ...]


def results_file(layout: Layout, assignment: str) -> Path:
    """Return the path of the last results of an assignment."""
    return layout.reports / assignment / 'results.json'


def last_results(layout: Layout, assignment: str) -> tuple[SubmissionResult, ...]:
    """Return the last results, none without a grading; GraderError if their file is damaged."""
    path = results_file(layout, assignment)
    if not path.is_file():
        return ()
    try:
        data = json.loads(path.read_text(encoding='utf-8'))
        return tuple(SubmissionResult.from_json(one) for one in data)
    except (ValueError, KeyError, TypeError) as error:
        raise GraderError(
            f'{path}: the results cannot be read ({type(error).__name__}).', 'Try: grade again'
        ) from error


def results_of_others(
    layout: Layout, assignment: str, students: Collection[str]
) -> tuple[SubmissionResult, ...]:
    """Return the last results of all students except the given ones."""
    last = last_results(layout, assignment)
    return tuple(one for one in last if one.student not in students)


def graded(layout: Layout, name: str | None = None) -> tuple[ClassResults, ...]:
    """Return the last results of one or all graded assignments; GraderError if there are none."""
    wanted = layout.assignments() if name is None else (layout.assignment_named(name),)
    there = [one for one in wanted if results_file(layout, one).is_file()]
    if not there:
        raise GraderError(
            f'{layout.reports}: there are no results for {name or "any assignment"}.',
            'Try: make grade',
        )
    return tuple(ClassResults(one, last_results(layout, one)) for one in there)


def has_mark(result: SubmissionResult) -> bool:
    """Return whether a result is a mark: not for review, and not from visible checks alone."""
    modes = [MODES[exam.mode] for exam in result.exams if exam.mode in MODES]
    return not result.review and all(mode.keeps_secrets for mode in modes)


def seconds_of_exam(exam: ExamResult) -> float:
    """Return the duration of running and judging an exam [s]."""
    return exam.timing.get('run_s', 0.0) + exam.timing.get('judge_s', 0.0)


def ran_s(result: SubmissionResult) -> float:
    """Return the duration of a submission's runs when they were recorded [s]; 0.0 if unknown."""
    return sum(exam.ran_s for exam in result.exams)


def modes(results: Iterable[SubmissionResult]) -> list[str]:
    """Return the isolation modes that were used."""
    return sorted({exam.mode for result in results for exam in result.exams if exam.mode})


def missing_protections(results: Iterable[SubmissionResult]) -> list[str]:
    """Return what the isolation of some runs did not protect; empty for full isolation."""
    exams = [exam for result in results for exam in result.exams]
    return list(dict.fromkeys(lack for exam in exams for lack in exam.not_protected))
