"""
Time the talker over 60 virtual seconds with all checks, and compare it with a lower bound.

The lower bound (the *floor*) is the least that any grader with this design must do: start the
sandbox, the probe and the student's node, and wait until the probe receives the first message.  It
is measured with the same sandbox, probe and file, and a scenario of two seconds.  Complete runs
and lower-bound runs alternate, so that both have the same load.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
import os
import statistics
import time
from typing import Any

from autograder.exam.exam import Advance, Exam
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.runs import observe as observing
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.forked import Probe, start_probe
from autograder.sandboxes.processes import usage
from autograder.sandboxes.sandbox import Sandbox
from autograder.submission.notebook import read_release
from autograder.submission.submission import answer_files
from benchmarks import report
from exams.visible.talker import build

SECONDS = 60.0
FULL_RUNS = 30
Marks = dict[str, float]

STEPS = (
    # mark at the end of the step, description of the step
    ('sandbox', 'lay out the files, start the sandbox'),
    ('probe ready', 'start the probe, and Python for the student'),
    ('@python', "let the student's program go"),
    ('@imported', "the student's imports"),
    ('@node', "rclpy.init and the student's node"),
    ('seen', 'discovery'),
    ('message', 'virtual time up to the first message'),
    ('end', 'the rest of the virtual minute'),
    ('closed', 'tear-down'),
    ('judged', 'judging'),
)
MARKERS = {'@python': 'import rclpy', '@imported': 'rclpy.init(', '@node': 'rclpy.spin('}
"""Marks that the program prints, with the beginning of the line before which it prints them."""


def marked(text: str) -> str:
    """
    Return the reference solution with three print calls that mark its progress.

    :raises RuntimeError: if the solution has changed and the places for the calls are not found
    """
    lines = text.split('\n')
    for marker, place in MARKERS.items():
        found = [number for number, line in enumerate(lines) if line.strip().startswith(place)]
        if len(found) != 1:
            raise RuntimeError(f'talker.py: expected {place!r} once; adapt this benchmark.')
        line = lines[found[0]]
        indent = line[: len(line) - len(line.lstrip())]
        lines.insert(found[0], f"{indent}print('{marker}', flush=True)")
    return '\n'.join(lines)


class _Clocked(observing._RunLoop):
    """The grader's own loop, which also stores the arrival times of the marks."""

    marks: Marks = {}  # noqa: RUF012 - one run at a time, so one table is enough
    cpu_s = 0.0

    def _read_events(self, data: bytes) -> None:
        before = len(self.events)
        super()._read_events(data)
        now = time.monotonic()
        if self.ready_s:
            self.marks.setdefault('probe ready', self.ready_s)
        for event in self.events[before:]:
            self.marks.setdefault(event['event'], now)

    def _record_surroundings(self) -> None:
        pids = *self.student.pids, self.probe.pid, self.clock.driver.pid
        _Clocked.cpu_s = sum(one.used_s for one in usage(*pids).each.values())
        super()._record_surroundings()

    def _read(self, pipes: Any, key: Any) -> None:
        super()._read(pipes, key)
        for marker in MARKERS:
            if f'{marker}\n'.encode() in self.output['stdout']:
                self.marks.setdefault(marker, time.monotonic())


def _clocked_start(*parts: Any) -> Probe:
    _Clocked.marks['sandbox'] = time.monotonic()
    return start_probe(*parts)


def whole_run(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> tuple[Marks, float]:
    """
    Run and judge the submission without keeping a recording.

    :returns: seconds from the start to each mark, and the processor time of the program, the
        probe, the clock's driver and the grader [s]
    :raises RuntimeError: if the submission does not get full points, because then the time is
        meaningless
    """
    _Clocked.marks.clear()
    began, cpu_began = time.monotonic(), time.process_time()
    result = Engine(sandbox).run(exam, files)
    ended = time.monotonic()
    if result.points != result.max_points:
        failed = ', '.join(check.check for check in result.failed)
        raise RuntimeError(f'The reference solution failed in {failed}.')
    closed = ended - result.timing['judge_s']
    cpu_s = _Clocked.cpu_s + time.process_time() - cpu_began
    return _since(began, {**_Clocked.marks, 'closed': closed, 'judged': ended}), cpu_s


def floor_run(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> Marks:
    """
    Start the submission and wait for its first message.

    :returns: seconds from the start to each mark
    :raises RuntimeError: if no message arrived
    """
    _Clocked.marks.clear()
    scenario = replace(exam.scenario, steps=(Advance(2.0),))
    began = time.monotonic()
    observing.observe(exam.name, scenario.to_json(), files, sandbox)
    ended = time.monotonic()
    if 'message' not in _Clocked.marks:
        raise RuntimeError('No message arrived in the run that should end with the first one.')
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
    exam = build('/lab', SECONDS)
    exam.scenario = replace(exam.scenario, again=None)
    exam.checks = [check for check in exam.checks if not check.again]
    layout = Layout.here()
    name = layout.release(exam.assignment).name
    solved = read_release(layout.solutions / exam.assignment / name)
    files = {exam.scenario.file: marked(answer_files(solved)[exam.name].body)}
    sandbox = strongest()
    observing._RunLoop = _Clocked  # type: ignore[misc, assignment]
    observing.start_probe = _clocked_start  # type: ignore[attr-defined, assignment]
    whole_run(exam, files, sandbox)  # read everything from disk once before measuring
    runs = [
        (floor_run(exam, files, sandbox), whole_run(exam, files, sandbox)) for _ in range(count)
    ]
    floor, complete = zip(*runs)
    whole, cpu_s = zip(*complete)
    whole_s = report.spread([marks['judged'] for marks in whole])
    first_s = report.spread([marks['message'] for marks in floor])
    closed_s = report.spread([marks['closed'] for marks in floor])
    figures = {
        'isolation': sandbox.mode,
        'exam': f'{SECONDS:g} virtual seconds, 2 messages a second, {len(exam.checks)} checks',
        'whole_s': whole_s,
        'whole_cpu_s': report.spread(cpu_s),
        'floor_s': first_s,
        'floor_with_tear_down_s': closed_s,
        'ratio': round(whole_s['median'] / first_s['median'], 2),
        'ratio_with_tear_down': round(whole_s['median'] / closed_s['median'], 2),
        'whole_steps_s': _medians(whole),
        'floor_steps_s': _medians(floor),
    }
    report.save('one_submission', facts, figures, full=count >= FULL_RUNS)


def _medians(runs: Sequence[Marks]) -> dict[str, float]:
    """Return the median duration of each step [s]; a step ends with its mark."""
    lengths: dict[str, list[float]] = {}
    for marks in runs:
        before = 0.0
        for mark, what in STEPS:
            if mark in marks:
                lengths.setdefault(what, []).append(marks[mark] - before)
                before = marks[mark]
    return {what: round(statistics.median(found), 4) for what, found in lengths.items()}


if __name__ == '__main__':
    main()
