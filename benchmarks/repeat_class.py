"""
Grade the sample class repeatedly, to find out whether all verdicts stay the same.

Each repeat runs everything again.  All parts of the results are compared, including texts, but not
times and pictures.  Processes that only use CPU time (``--busy``) show whether load changes a
verdict.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import hashlib
import json
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time
from typing import Any

from autograder.authoring.sample_class import write_sample_class
from autograder.grading.pipeline import grade_class, load_lesson, SandboxEngine
from autograder.layout import Layout
from autograder.runs.grading_folder import grading_folder
from autograder.sandboxes.choose import strongest
from autograder.submission.inbox import discover
from benchmarks import report

FULL_REPEATS = 50
Outcome = dict[str, str]


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if the outcomes differ
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    outcomes: list[Outcome] = []
    walls: list[float] = []
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder, busy(chosen.busy):
        submitted = Path(folder, 'submitted')
        write_sample_class(Layout.here(), submitted)
        try:
            for number in range(chosen.repeats):
                began = time.monotonic()
                outcomes.append(_grade_once(submitted, Path(folder, str(number)), chosen.jobs))
                walls.append(time.monotonic() - began)
                same = len({_digest(outcome) for outcome in outcomes}) == 1
                said = 'all the same so far' if same else 'NOT all the same'
                print(f'repeat {number + 1}: {walls[-1]:.1f} s, {said}', flush=True)
        except KeyboardInterrupt:
            print('Stopped; this is what was seen until now.')
    if not walls:
        return 1
    figures = {'jobs': chosen.jobs, 'busy': chosen.busy, **_figures(outcomes, walls)}
    _print(facts, figures)
    name = f'repeat_class_busy_{chosen.busy}' if chosen.busy else 'repeat_class'
    report.save(name, facts, figures, full=figures['repeats'] >= FULL_REPEATS)
    return 0 if figures['distinct_outcomes'] == 1 else 1


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.repeat_class')
    help_text = 'how often to grade the class (default: %(default)s)'
    parser.add_argument('--repeats', type=int, default=FULL_REPEATS, metavar='N', help=help_text)
    help_text = 'runs at a time (default: one per processor, here %(default)s)'
    parser.add_argument(
        '--jobs', type=int, default=os.cpu_count() or 1, metavar='N', help=help_text
    )
    help_text = 'processes that burn processor time meanwhile (default: %(default)s)'
    parser.add_argument('--busy', type=int, default=0, metavar='N', help=help_text)
    return parser.parse_args()


BURN = 'import os\nparent = os.getppid()\nwhile os.getppid() == parent: pass'
"""A busy loop that ends when the benchmark ends, even if the benchmark is killed."""


@contextmanager
def busy(count: int) -> Iterator[None]:
    """Keep some CPUs busy inside the ``with`` block."""
    burners = [subprocess.Popen([sys.executable, '-S', '-c', BURN]) for _ in range(count)]
    try:
        yield
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


def _grade_once(submitted: Path, recordings: Path, jobs: int) -> Outcome:
    """
    Grade the class with a new folder of recordings, so that every program runs again.

    :returns: every value in the results by its path, as JSON
    """
    layout = Layout.here()
    outcome: Outcome = {}
    engine = SandboxEngine(strongest(), recordings, fresh=True)
    with grading_folder():
        for assignment in layout.assignments():
            lesson = load_lesson(layout, assignment, engine)
            submissions = discover(submitted, assignment, lesson.notebook, layout.assignments())
            for one in grade_class(submissions, lesson, engine, jobs):
                data = one.result.to_json()
                place = f'{one.result.student}/{assignment}'
                outcome.update(_facts(data, place))
    return outcome


def _facts(data: Any, place: str) -> Iterator[tuple[str, str]]:
    """Yield the values of a result by path, without times and pictures, which vary."""
    if isinstance(data, dict):
        for name, value in data.items():
            if name not in ('timing', 'pictures'):
                yield from _facts(value, f'{place}/{name}')
    elif isinstance(data, (list, tuple)):
        yield f'{place}/number', str(len(data))
        for index, value in enumerate(data):
            name = value.get('check') or value.get('exam') if isinstance(value, dict) else None
            yield from _facts(value, f'{place}/{name or index}')
    else:
        yield place, json.dumps(data)


def _digest(outcome: Outcome) -> str:
    return hashlib.sha256(json.dumps(outcome, sort_keys=True).encode()).hexdigest()[:12]


def _figures(outcomes: Sequence[Outcome], walls: Sequence[float]) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    places = sorted({place for outcome in outcomes for place in outcome})
    differ: dict[str, dict[str, int]] = {}
    for place in places:
        seen = Counter(outcome.get(place, 'missing') for outcome in outcomes)
        if len(seen) > 1:
            differ[place] = dict(seen.most_common())
    return {
        'repeats': len(outcomes),
        'submissions': len({place.split('/')[0] for place in places}),
        'checks': sum(place.endswith('/verdict') for place in outcomes[0]),
        'distinct_outcomes': len({_digest(outcome) for outcome in outcomes}),
        'differing_verdicts': sum(place.endswith('/verdict') for place in differ),
        'differing': differ,
        'wall_s': report.spread(walls),
    }


def _print(facts: dict[str, Any], figures: dict[str, Any]) -> None:
    print(f'\nThe sample class, {figures["submissions"]} submissions, graded again and again\n')
    report.print_machine(facts)
    wall = figures['wall_s']
    rows: list[list[object]] = [
        ['repeats', figures['repeats']],
        ['checks in each', figures['checks']],
        ['distinct outcomes', figures['distinct_outcomes']],
        ['checks with another verdict', figures['differing_verdicts']],
        ['one repeat, median [s]', wall['median']],
        ['one repeat, least to most [s]', f'{wall["least"]:.1f} to {wall["most"]:.1f}'],
        ['runs at a time', figures['jobs']],
        ['burners', figures['busy']],
    ]
    report.print_table(['', ''], rows)
    # Equal files run once per repeat, so many submissions may differ in the same way.
    alike: dict[tuple[str, str], list[str]] = {}
    for place, seen in figures['differing'].items():
        student, _, rest = place.partition('/')
        said = '\n'.join(f'    {count} times {value[:150]}' for value, count in seen.items())
        alike.setdefault((rest, said), []).append(student)
    for (rest, said), students in alike.items():
        more = f' and {len(students) - 1} more' if len(students) > 1 else ''
        print(f'{students[0]}{more}: {rest}\n{said}')


if __name__ == '__main__':
    sys.exit(main())
