"""
Compute the statistics of a class: marks, checks, slow runs and flags.

All numbers come from the last results.  Submissions for review have no mark and appear only in a
separate list.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
import json
import math
from pathlib import Path
import statistics
from typing import Any

from autograder.classroom.results_of_class import (
    ClassResults,
    has_mark,
    missing_protections,
    modes,
    ran_s,
)
from autograder.classroom.standing import Standing, without_result
from autograder.explaining.feedback import number
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict

BINS = 10
SLOWEST = 5
CAUSES = 3
DIGEST_CHARS = 12
HEADER_BYTES = 4096
"""Maximum size of the header, which is the first line of a recording [bytes]."""
Header = Mapping[str, Any]


@dataclass(frozen=True)
class Marks:
    """
    The distribution of the points.

    :param bins: number of submissions with 0 to below 10 % of the points, 10 to below 20 %, ...,
        90 to 100 %
    """

    count: int
    max_points: float
    mean: float
    median: float
    lower_quartile: float
    upper_quartile: float
    lowest: float
    highest: float
    full: int
    bins: tuple[int, ...]

    def rows(self) -> list[tuple[str, str, int]]:
        """Return the bins: both edges as text, and the number of submissions."""
        edges = [number(self.max_points * edge / BINS) for edge in range(BINS + 1)]
        return list(zip(edges, edges[1:], self.bins))


@dataclass(frozen=True)
class CheckNumbers:
    """The results of a class in one check, with the most frequent causes and their frequency."""

    exam: str
    check: str
    title: str
    passed: int
    failed: int
    not_run: int
    max_points: float
    mean_points: float
    causes: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class ClassNumbers:
    """
    The statistics of one assignment.

    :param marks: None if nobody has a mark
    :param review: students without a score, each with the reason
    :param slowest: the slowest students, each with the duration of the runs as recorded [s]
    :param recorded: number of submissions that needed no run in the last grading
    :param lacks: what these modes do not protect
    :param exams: digests of the scenario (with its inputs) and of the environment, by exam
    :param versions: versions of the software that made the recordings, by name; several
        versions of one program are joined in one string
    """

    assignment: str
    submissions: int
    marks: Marks | None
    checks: tuple[CheckNumbers, ...]
    review: tuple[tuple[str, str], ...]
    missing: tuple[Standing, ...]
    flagged: tuple[tuple[str, str], ...]
    slowest: tuple[tuple[str, float], ...]
    recorded: int
    modes: tuple[str, ...]
    lacks: tuple[str, ...]
    exams: dict[str, dict[str, tuple[str, ...]]]
    versions: dict[str, str]


def class_numbers(layout: Layout, graded: ClassResults) -> ClassNumbers:
    """Return the statistics of a class; GraderError if the class list is wrong."""
    results = graded.results
    exams = [exam for result in results for exam in result.exams]
    slowest = sorted(filter(ran_s, results), key=ran_s, reverse=True)
    headers: dict[str, list[Header]] = {}
    for exam, name in dict.fromkeys((one.exam, one.recording) for one in exams):
        header = _header(layout.recordings / exam / name) if name else {}
        headers.setdefault(exam, []).append(header)
    return ClassNumbers(
        assignment=graded.assignment,
        submissions=len(results),
        marks=_marks([result for result in results if has_mark(result)]),
        checks=_checks([exam for one in results if not one.review for exam in one.exams]),
        review=tuple((one.student, one.review) for one in results if one.review),
        missing=without_result(layout, graded.assignment, results),
        flagged=tuple((one.student, flag) for one in results for flag in one.flags),
        slowest=tuple((one.student, ran_s(one)) for one in slowest[:SLOWEST]),
        recorded=sum(not any(x.timing.get('run_s') for x in one.exams) for one in results),
        modes=tuple(modes(results)),
        lacks=tuple(missing_protections(results)),
        exams={
            exam: {name: _texts(found, name, DIGEST_CHARS) for name in ('scenario', 'environment')}
            for exam, found in headers.items()
        },
        versions=_versions([*chain(*headers.values())]),
    )


def _marks(results: Sequence[SubmissionResult]) -> Marks | None:
    most = max((result.max_points for result in results), default=0.0)
    if not results or most <= 0:
        return None
    points = sorted(result.points for result in results)
    bins = [0] * BINS
    for one in points:
        # Allow for rounding: the sum of the points may be 39.99999 instead of 40.
        bins[max(0, min(BINS - 1, math.floor(one / most * BINS + 1e-6)))] += 1
    low, middle, high = (
        statistics.quantiles(points, n=4, method='inclusive') if len(points) > 1 else points * 3
    )
    return Marks(
        count=len(points),
        max_points=most,
        mean=statistics.fmean(points),
        median=middle,
        lower_quartile=low,
        upper_quartile=high,
        lowest=points[0],
        highest=points[-1],
        full=sum(one >= most - 1e-6 for one in points),
        bins=tuple(bins),
    )


def _checks(exams: Sequence[ExamResult]) -> tuple[CheckNumbers, ...]:
    """Return the statistics of every check, in the order of the exams."""
    found: dict[tuple[str, str], list[CheckResult]] = {}
    for exam in exams:
        for check in exam.checks:
            found.setdefault((exam.exam, check.check), []).append(check)
    return tuple(_check(exam, checks) for (exam, _), checks in found.items())


def _check(exam: str, checks: Sequence[CheckResult]) -> CheckNumbers:
    verdicts = Counter(check.verdict for check in checks)
    return CheckNumbers(
        exam=exam,
        check=checks[0].check,
        title=checks[0].title,
        passed=verdicts[Verdict.PASSED],
        failed=verdicts[Verdict.FAILED],
        not_run=verdicts[Verdict.NOT_RUN],
        max_points=max(check.max_points for check in checks),
        mean_points=statistics.fmean(check.points for check in checks),
        causes=_causes([check for check in checks if check.verdict is Verdict.FAILED]),
    )


def _causes(failed: Sequence[CheckResult]) -> tuple[tuple[str, int], ...]:
    """
    Return the most frequent causes of a check as text.

    Causes are counted by their stable name, because their text contains line numbers and values
    that differ between students.  For each cause, the most frequent text is returned.
    """
    words: dict[str, Counter[str]] = {}
    for check in failed:
        text = check.cause or check.observed or 'no cause was found'
        words.setdefault(check.cause_id or text, Counter())[text] += 1
    counted = sorted(words.values(), key=lambda texts: -texts.total())
    return tuple((texts.most_common(1)[0][0], texts.total()) for texts in counted[:CAUSES])


def _versions(headers: Sequence[Header]) -> dict[str, str]:
    """Return the software versions in the headers; this machine may now have others."""
    made = [one['made_with'] for one in headers if isinstance(one.get('made_with'), dict)]
    found = {name: _texts(made, name) for name in dict.fromkeys(chain(*made))}
    found['environment'] = _texts(headers, 'environment', DIGEST_CHARS)
    return {name: ' and '.join(texts) for name, texts in found.items() if texts}


def _texts(headers: Sequence[Header], name: str, most: int | None = None) -> tuple[str, ...]:
    """Return the distinct values of one field in the headers, as strings of limited length."""
    return tuple(dict.fromkeys(str(one[name])[:most] for one in headers if name in one))


def _header(path: Path) -> Header:
    """Return the header of a recording; empty if the file is missing or damaged."""
    try:
        with path.open('rb') as file:
            data = json.loads(file.readline(HEADER_BYTES))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
