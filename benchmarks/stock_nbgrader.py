"""
Grade six submissions with the same exam in stock nbgrader and in this project.

The two run one after the other on this machine, and both write a gradebook.  Stock nbgrader
executes the tests in the student's kernel and waits a real minute for each minute of messages.
"""

import argparse
from collections.abc import Mapping, Sequence
import os
from pathlib import Path
import tempfile
from typing import Any

from benchmarks import reduced_course, report, stock_course
from benchmarks.reduced_course import ASSIGNMENT, Graded, publishers, SIX

FULL_S = 60
GRADE_CELL = 'check_temperature_publisher'
Points = Mapping[str, Mapping[str, float]]


def main() -> None:
    """Measure, then print and save the figures."""
    chosen = _arguments()
    names = tuple(chosen.submissions.split(',')) if chosen.submissions else SIX
    facts = report.machine()
    answers = publishers(names)
    ours: dict[int, list[Graded]] = {jobs: [] for jobs in {os.cpu_count() or 1, 1}}
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        stock_root, project_root = Path(folder, 'stock'), Path(folder, 'project')
        for root in (stock_root, project_root):
            root.mkdir()
        stock_course.build(stock_root, answers, chosen.seconds)
        layout = reduced_course.build(project_root, answers, chosen.seconds)
        # Measure this project before and after stock nbgrader, to reveal a change in load.
        for number in range(chosen.project_runs):
            for jobs, runs in ours.items():
                print(f'this project, --jobs {jobs}, run {number + 1} ...', flush=True)
                runs.append(reduced_course.grade(layout, '--fresh', '--jobs', str(jobs)))
            if number == 0:
                print(f'stock nbgrader, about {chosen.seconds * len(names)} s ...', flush=True)
                stock_s = stock_course.autograde(stock_root)
        entered = stock_course.points(layout.work / 'gradebook.db', ASSIGNMENT)
        theirs = stock_course.points(stock_root / 'gradebook.db', stock_course.ASSIGNMENT)
    walls = {
        f'--jobs {jobs}': report.spread([run.wall_s for run in runs])
        for jobs, runs in ours.items()
    }
    all_ours = [run for runs in ours.values() for run in runs]
    figures = {
        'exam': f'{chosen.seconds} s at 1 Hz, 8 checks',
        'submissions': len(names),
        'stock_wall_s': round(stock_s, 2),
        'project_wall_s': {
            options: {**wall, 'times_faster': round(stock_s / wall['median'], 1)}
            for options, wall in walls.items()
        },
        'verdicts': {
            name: _verdicts(name, theirs[name], all_ours, entered[name].get(GRADE_CELL))
            for name in names
        },
    }
    full = chosen.seconds == FULL_S and names == SIX
    report.save('stock_nbgrader', facts, figures, full=full)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.stock_nbgrader')
    help_text = 'duration of the exam [s] (default: 60, as in grading)'
    parser.add_argument('--seconds', type=int, default=FULL_S, metavar='S', help=help_text)
    help_text = 'how often this project grades the class (default: %(default)s)'
    parser.add_argument('--project-runs', type=int, default=3, metavar='N', help=help_text)
    help_text = 'other sample submissions, separated by commas'
    parser.add_argument('--submissions', default='', metavar='NAMES', help=help_text)
    return parser.parse_args()


def _verdicts(
    name: str, theirs: Mapping[str, float], ours: Sequence[Graded], entered: float | None
) -> dict[str, Any]:
    """
    Compare the verdicts of both graders on one submission, in every run.

    :param theirs: stock nbgrader's points by check
    :param entered: points in this project's gradebook
    """
    found = [run.points[name] for run in ours]
    most = sum(check['max_points'] for check in ours[0].checks[name].values())
    last, stock = found[-1], sum(theirs.values())
    return {
        'stock_points': stock,
        'project_points': sum(last.values()),
        'in_gradebook': entered == sum(last.values()),
        'same_pass_or_fail': {sum(points.values()) == most for points in found} == {stock == most},
        'project_runs_agree': all(points == last for points in found),
        'checks_that_differ': sorted(
            check for check in last.keys() | theirs.keys() if last.get(check) != theirs.get(check)
        ),
    }


if __name__ == '__main__':
    main()
