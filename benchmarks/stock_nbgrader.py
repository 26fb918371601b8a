"""
Grade the same six submissions with the same exam, by stock nbgrader and by this project.

Both run one after the other on this machine, and both write a gradebook.  Stock nbgrader executes
the tests in the student's kernel and waits a real minute for each minute of messages.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
import os
from pathlib import Path
import statistics
import tempfile
from typing import Any

from benchmarks import reduced_course, report, stock_course
from benchmarks.reduced_course import ProjectRun
from benchmarks.stock_course import StockRun
from benchmarks.submissions import ASSIGNMENT, publishers, SIX

FULL_S = 60
GRADE_CELL = 'check_temperature_publisher'
Points = Mapping[str, Mapping[str, float]]


def main() -> None:
    """Measure, then print and save the figures."""
    chosen = _arguments()
    names = tuple(chosen.submissions.split(',')) if chosen.submissions else SIX
    facts = report.machine()
    answers = publishers(names)
    job_counts = sorted({os.cpu_count() or 1, 1}, reverse=True)
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        stock_root, project_root = Path(folder, 'stock'), Path(folder, 'project')
        for root in (stock_root, project_root):
            root.mkdir()
        stock_course.build(stock_root, answers, chosen.seconds)
        layout = reduced_course.build(project_root, answers, chosen.seconds)
        ours: dict[int, list[ProjectRun]] = {jobs: [] for jobs in job_counts}
        stock: list[StockRun] = []
        # Measure this project before and after stock nbgrader, so that a change of load becomes
        # visible.
        for number in range(chosen.project_runs):
            for jobs in job_counts:
                print(f'this project, --jobs {jobs}, run {number + 1} ...', flush=True)
                ours[jobs].append(reduced_course.grade(layout, jobs))
            if number == 0:
                print(f'stock nbgrader, about {chosen.seconds * len(names)} s ...', flush=True)
                stock.append(stock_course.autograde(stock_root))
        entered = stock_course.points(layout.work / 'gradebook.db', ASSIGNMENT)
    figures = _figures(chosen.seconds, names, stock[0], ours, entered)
    _print(facts, figures)
    full = chosen.seconds == FULL_S and names == SIX
    report.save('stock_nbgrader', facts, figures, full=full)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.stock_nbgrader')
    help_text = 'length of the exam (default: 60, as it is graded)'
    parser.add_argument('--seconds', type=int, default=FULL_S, metavar='S', help=help_text)
    help_text = 'how often this project grades the class (default: %(default)s)'
    parser.add_argument('--project-runs', type=int, default=3, metavar='N', help=help_text)
    help_text = 'other sample submissions, separated by commas'
    parser.add_argument('--submissions', default='', metavar='NAMES', help=help_text)
    return parser.parse_args()


def _figures(
    seconds: int,
    names: Sequence[str],
    stock: StockRun,
    ours: Mapping[int, Sequence[ProjectRun]],
    entered: Points,
) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    project = {
        f'--jobs {jobs}': {
            **report.spread([run.wall_s for run in runs]),
            'times_faster': round(stock.wall_s / statistics.median(r.wall_s for r in runs), 1),
        }
        for jobs, runs in ours.items()
    }
    return {
        'exam': f'{seconds} s at 1 Hz, 8 checks',
        'submissions': len(names),
        'stock_wall_s': round(stock.wall_s, 2),
        'stock_each_s': {name: round(stock.each_s[name], 2) for name in names},
        'project_wall_s': project,
        'verdicts': {name: _verdicts(name, stock, ours, entered) for name in names},
    }


def _verdicts(
    name: str, stock: StockRun, ours: Mapping[int, Sequence[ProjectRun]], entered: Points
) -> dict[str, Any]:
    """Compare the verdicts of both graders on one submission, in every run."""
    theirs = stock.points[name]
    runs = [run for group in ours.values() for run in group]
    found = [run.points()[name] for run in runs]
    full = [
        sum(c['max_points'] for e in run.results[name]['exams'] for c in e['checks'])
        for run in runs
    ]
    right = [sum(points.values()) == maximum for points, maximum in zip(found, full)]
    stock_right = sum(theirs.values()) == full[0]
    last = found[-1]
    return {
        'stock_points': sum(theirs.values()),
        'project_points': sum(last.values()),
        'in_gradebook': entered[name].get(GRADE_CELL) == sum(last.values()),
        'same_pass_or_fail': all(ours == stock_right for ours in right),
        'project_runs_agree': all(points == last for points in found),
        'checks_that_differ': sorted(
            check for check in last.keys() | theirs.keys() if last.get(check) != theirs.get(check)
        ),
    }


def _print(facts: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
    count = figures['submissions']
    print(f'\n{count} submissions, one exam: {figures["exam"]}\n')
    report.print_machine(facts)
    wall = figures['stock_wall_s']
    rows: list[list[object]] = [['nbgrader autograde', 1, wall, wall / count, '']]
    for options, runs in figures['project_wall_s'].items():
        times = f'{runs["times_faster"]:.1f} x'
        rows.append(
            [
                f'autograder grade {options}',
                runs['count'],
                runs['median'],
                runs['median'] / count,
                times,
            ]
        )
    report.print_table(['', 'runs', 'median wall [s]', 'per submission [s]', 'faster'], rows)
    headings = ['submission', 'nbgrader [s]', 'nbgrader', 'project', 'same pass or fail']
    rows = [
        [
            name,
            figures['stock_each_s'][name],
            f'{said["stock_points"]:g}',
            f'{said["project_points"]:g}',
            said['same_pass_or_fail'],
        ]
        for name, said in figures['verdicts'].items()
    ]
    report.print_table(headings, rows)
    for name, said in figures['verdicts'].items():
        if said['checks_that_differ']:
            print(f'{name}: points differ in {", ".join(said["checks_that_differ"])}')
        if not said['project_runs_agree']:
            print(f"{name}: this project's own runs differ")
        if not said['in_gradebook']:
            print(f"{name}: this project's gradebook has other points")


if __name__ == '__main__':
    main()
