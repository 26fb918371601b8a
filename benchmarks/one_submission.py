"""
Time one submission over 60 virtual seconds with all checks, and compare it with a lower bound.

The lower bound (the *floor*) is the least that any grader with this design must do: start the
sandbox, the probe and the student's node, and wait until the probe receives the first message.  It
is measured with the same sandbox, probe and file, and a scenario of two seconds.  Complete runs
and lower-bound runs alternate, so that both have the same load.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
import os
from pathlib import Path
import statistics
import time
from typing import Any

from autograder.exam import catalog
from autograder.exam.exam import Advance, Exam, Scenario
from autograder.grading.examine import examine
from autograder.runs import observe as observing
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confined import Confined, Limits, Program
from autograder.sandboxes.sandbox import Sandbox
from benchmarks import report
from benchmarks.submissions import EXAM, publishers, REFERENCE

FILE = 'temp_publisher.py'
FULL_RUNS = 15
Marks = dict[str, float]

STEPS = (
    # mark at the end of the step, description of the step
    ('sandbox', 'lay out the files, start the sandbox'),
    ('probe ready', 'start the probe, and Python for the student'),
    ('@python', "let the student's program go"),
    ('@imported', "the student's imports"),
    ('@node', "rclpy.init and the student's node"),
    ('seen', 'discovery'),
    ('first message', 'virtual time up to the first message'),
    ('end', 'the rest of the virtual minute'),
    ('closed', 'tear-down'),
    ('judged', 'judging'),
)
MARKERS = ('@python', '@imported', '@node')


def marked(text: str) -> str:
    """
    Return the reference solution with three print calls that mark its progress.

    :raises RuntimeError: if the solution has changed and the places for the calls are not found
    """
    lines = text.split('\n')
    for marker, place in zip(MARKERS, ('import math', 'rclpy.init(', 'rclpy.spin(')):
        found = [number for number, line in enumerate(lines) if line.strip().startswith(place)]
        if len(found) != 1:
            raise RuntimeError(f'{FILE}: expected {place!r} once; adapt this benchmark.')
        line = lines[found[0]]
        indent = line[: len(line) - len(line.lstrip())]
        lines.insert(found[0], f"{indent}print('{marker}', flush=True)")
    return '\n'.join(lines)


class _Clocked(observing._Watched):
    """The grader's own loop, which also stores the arrival times of the marks."""

    marks: Marks = {}  # noqa: RUF012 - one run at a time, so one table is enough

    def _recorded(self, data: bytes) -> None:
        before = len(self.events)
        super()._recorded(data)
        now = time.monotonic()
        if self.ready_s:
            self.marks.setdefault('probe ready', self.ready_s)
        for event in self.events[before:]:
            kind = 'first message' if event['event'] == 'message' else event['event']
            self.marks.setdefault(kind, now)

    def _read(self, pipes: Any, key: Any) -> None:
        super()._read(pipes, key)
        if key.data == 'stdout':
            for marker in MARKERS:
                if f'{marker}\n'.encode() in self.output['stdout']:
                    self.marks.setdefault(marker, time.monotonic())


class _ClockedSandbox(Sandbox):
    """The sandbox, which also stores the time when it was ready."""

    def start(
        self, program: Program, limits: Limits, home: Path, inherited: Sequence[int] = ()
    ) -> Confined:
        """Start a program and store the time."""
        confined = super().start(program, limits, home, inherited)
        _Clocked.marks['sandbox'] = time.monotonic()
        return confined


def floor_of(scenario: Scenario) -> Scenario:
    """Return a copy of the scenario that ends soon after the first message."""
    return replace(scenario, steps=(Advance(2.0),))


def whole_run(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> Marks:
    """
    Run and judge the submission without keeping a recording.

    :returns: seconds from the start to each mark
    :raises RuntimeError: if the submission does not get full points, because then the time is
        meaningless
    """
    _Clocked.marks.clear()
    began = time.monotonic()
    result = examine(exam, files, sandbox=sandbox)
    ended = time.monotonic()
    if result.points != result.max_points:
        failed = ', '.join(check.check for check in result.failed)
        raise RuntimeError(f'The reference solution failed in {failed}.')
    closed = ended - result.timing['judge_s']
    return _since(began, {**_Clocked.marks, 'closed': closed, 'judged': ended})


def floor_run(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> Marks:
    """
    Start the submission and wait for its first message.

    :returns: seconds from the start to each mark
    :raises RuntimeError: if no message arrived
    """
    _Clocked.marks.clear()
    began = time.monotonic()
    observing.observe(exam.name, floor_of(exam.scenario).to_json(), files, sandbox)
    ended = time.monotonic()
    if 'first message' not in _Clocked.marks:
        raise RuntimeError('No message came in the run that should end with the first one.')
    return _since(began, {**_Clocked.marks, 'closed': ended})


def _since(began: float, marks: Marks) -> Marks:
    return {mark: at - began for mark, at in marks.items()}


def main() -> None:
    """Measure, then print and save the figures."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.one_submission')
    help_text = 'whole runs and floor runs, each (default: %(default)s)'
    parser.add_argument('--runs', type=int, default=FULL_RUNS, metavar='N', help=help_text)
    count = parser.parse_args().runs
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    exam = catalog.load(EXAM)
    files = {FILE: marked(publishers([REFERENCE])[REFERENCE])}
    sandbox = _ClockedSandbox(strongest().mode)
    observing._Watched = _Clocked  # type: ignore[misc]
    whole_run(exam, files, sandbox)  # read everything from disk once before measuring
    whole, floor = [], []
    for _ in range(count):
        floor.append(floor_run(exam, files, sandbox))
        whole.append(whole_run(exam, files, sandbox))
    figures = _figures(exam, whole, floor)
    _print(facts, figures)
    figures = {'isolation': sandbox.mode, **figures}
    report.save('one_submission', facts, figures, full=count >= FULL_RUNS)


def _figures(exam: Exam, whole: Sequence[Marks], floor: Sequence[Marks]) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    whole_s = report.spread([marks['judged'] for marks in whole])
    first_s = report.spread([marks['first message'] for marks in floor])
    closed_s = report.spread([marks['closed'] for marks in floor])
    seconds = sum(step.seconds for step in exam.scenario.steps if isinstance(step, Advance))
    return {
        'exam': f'{seconds:g} virtual seconds, {len(exam.checks)} checks',
        'whole_s': whole_s,
        'floor_s': first_s,
        'floor_with_tear_down_s': closed_s,
        'ratio': round(whole_s['median'] / first_s['median'], 2),
        'ratio_with_tear_down': round(whole_s['median'] / closed_s['median'], 2),
        'whole_steps_s': _medians(whole),
        'floor_steps_s': _medians(floor),
    }


def _lengths(runs: Sequence[Marks]) -> dict[str, list[float]]:
    """Return the duration of each step in each run [s]; a step ends with its mark."""
    lengths: dict[str, list[float]] = {}
    for marks in runs:
        before = 0.0
        for mark, _ in STEPS:
            if mark in marks:
                lengths.setdefault(mark, []).append(marks[mark] - before)
                before = marks[mark]
    return lengths


def _medians(runs: Sequence[Marks]) -> dict[str, float]:
    found = _lengths(runs)
    return {
        what: round(statistics.median(found[mark]), 4) for mark, what in STEPS if mark in found
    }


def _print(facts: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
    print(f'One publisher, {figures["exam"]}\n')
    report.print_machine(facts)
    rows: list[list[object]] = []
    for what, name, ratio in (
        ('whole: start to verdicts', 'whole_s', None),
        ('floor: start to first message', 'floor_s', figures['ratio']),
        ('floor with tear-down', 'floor_with_tear_down_s', figures['ratio_with_tear_down']),
    ):
        times = figures[name]
        share = f'{ratio:.2f} x' if ratio else ''
        rows.append([what, times['count'], times['median'], times['least'], times['most'], share])
    headings = ['', 'runs', 'median [s]', 'least [s]', 'most [s]', 'whole / floor']
    report.print_table(headings, rows)
    total = figures['whole_s']['median']
    rows = [
        [what, seconds, f'{100 * seconds / total:.0f} %', figures['floor_steps_s'].get(what)]
        for what, seconds in figures['whole_steps_s'].items()
    ]
    report.print_table(['where the time goes (medians)', 'whole [s]', '', 'floor [s]'], rows)
    longest = max(figures['whole_steps_s'], key=lambda what: figures['whole_steps_s'][what])
    print(f'Most of it: {longest}.\n')


if __name__ == '__main__':
    main()
