"""The command ``stats``: the statistics of a class as text."""

import argparse
from collections.abc import Sequence

from autograder.classroom.results_of_class import graded
from autograder.classroom.standing import absent, BY_HAND, by_status, CHANGED, TO_GRADE
from autograder.classroom.statistics import class_numbers, ClassNumbers
from autograder.commands import ASSIGNMENT_OR_ALL, FOR_REVIEW, OK, takes
from autograder.explaining.feedback import number, printable
from autograder.gradebook.database import to_grade_by_hand
from autograder.layout import Layout
from autograder.results import shortened

BAR = 40
CAUSE_CHARS = 100


@takes(ASSIGNMENT_OR_ALL)
def run(chosen: argparse.Namespace) -> int:
    """Print the statistics of a class."""
    layout = Layout.here()
    classes = graded(layout, chosen.assignment)
    found = [class_numbers(layout, one) for one in classes]
    by_hand = [to_grade_by_hand(layout, one.assignment, one.results) for one in classes]
    print('\n\n'.join(map(stats_text, found, by_hand)))
    return FOR_REVIEW if any(one.review for one in found) else OK


def stats_text(numbers: ClassNumbers, by_hand: Sequence[str] = ()) -> str:
    """Return the statistics of a class as plain text; ``by_hand``: students to grade by hand."""
    lines = [
        f'{numbers.assignment}: {numbers.submissions} submission{"s" * (numbers.submissions != 1)}'
    ]
    lines += [f'  for review: {student}: {fault}' for student, fault in numbers.review]
    waiting = [(one.student, one.status) for one in numbers.missing if one.status in TO_GRADE]
    waiting += [(student, BY_HAND) for student in by_hand if (student, CHANGED) not in waiting]
    lines += [f'  {line}' for line in by_status(waiting)]
    lines += [f'  missing: {one.student}: {one.reason}' for one in absent(numbers.missing)]
    lines += _marks_lines(numbers)
    if numbers.checks:
        lines.append('  failed  not run  mean points  check')
    for check in numbers.checks:
        mean = f'{number(check.mean_points)} of {number(check.max_points)}'
        lines.append(
            f'  {check.failed:6}  {check.not_run:7}  {mean:>11}  {check.exam}/{check.check}'
        )
        for words, count in check.causes[:1]:
            words = shortened(' '.join(words.split()), CAUSE_CHARS)
            lines.append(f'{"":33}{count} of {check.failed}: {words}')
    lines += [f'  flag: {student}: {flag}' for student, flag in numbers.flagged]
    lines += [f'  slowest: {student}: {seconds:.1f} s' for student, seconds in numbers.slowest]
    if numbers.recorded:
        lines.append(f'  {numbers.recorded} needed no run: already recorded, or nothing to run')
    lines += [f'  NOT PROTECTED: {lack}' for lack in numbers.lacks]
    lines.append(f'  isolation {", ".join(numbers.modes) or "none needed"}')
    if numbers.versions:
        versions = ', '.join(f'{name} {text}' for name, text in numbers.versions.items())
        lines.append(f'  recorded with {versions}')
    return printable('\n'.join(lines))


def _marks_lines(numbers: ClassNumbers) -> list[str]:
    marks = numbers.marks
    if marks is None:
        return ['  no student has a mark']
    lines = [
        f'  points out of {number(marks.max_points)}: mean {number(marks.mean)}, median '
        f'{number(marks.median)}, quartiles {number(marks.lower_quartile)} and '
        f'{number(marks.upper_quartile)}, from {number(marks.lowest)} to '
        f'{number(marks.highest)}; {marks.full} of {marks.count} have full marks'
    ]
    most = max(marks.bins)
    for low, high, count in marks.rows():
        bar = '#' * round(BAR * count / most)
        lines.append(f'  {low:>6} - {high:<6} {count:4} {bar}'.rstrip())
    return lines
