"""
Run every style of timing on the virtual clock repeatedly, with and without load.

The programs are those of ``tests/clock/time_styles.py``; each runs for a virtual minute in the
grader's own sandbox.  Two runs agree if the same events are recorded at each instant, to the
nanosecond.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
import json
import statistics
import sys
import time

from autograder.exam.scenario import Advance, Scenario
from autograder.recording import Recording
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.sandbox import Sandbox
from benchmarks import report
from benchmarks.repeat_class import busy
from tests.clock.test_styles import ASKED, recording, WATCHED
from tests.clock.time_styles import ANSWERING, STYLES

REPEATS, BUSY = 20, 8
MINUTE = replace(WATCHED, steps=(Advance(59.8),))


def programs() -> dict[str, tuple[str, Scenario]]:
    """Return the program and the scenario of each style."""
    timed = {name: (body, MINUTE) for name, (body, _) in STYLES.items()}
    return {**timed, **{f'answers {name}': (body, ASKED) for name, body in ANSWERING.items()}}


def transcript(found: Recording) -> str:
    """Return the recorded events as text; the order of events at one instant does not matter."""
    events = [event for event in found.events if event['event'] in ('message', 'log', 'input')]
    return json.dumps(sorted(events, key=lambda one: (one['clock_ns'], json.dumps(one))))


def measure(body: str, scenario: Scenario, sandbox: Sandbox, repeats: int) -> tuple[int, float]:
    """
    Run one style several times.

    :returns: number of runs that differ from the most frequent result, and the median wall time
        [s]
    """
    seen: dict[str, int] = {}
    times = []
    for _ in range(repeats):
        began = time.monotonic()
        heard = transcript(recording(body, scenario, sandbox))
        times.append(time.monotonic() - began)
        seen[heard] = seen.get(heard, 0) + 1
    return repeats - max(seen.values()), statistics.median(times)


def main() -> None:
    """Measure, then print and save the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--repeats', type=int, default=REPEATS, help='runs of each style')
    parser.add_argument('--busy', type=int, default=BUSY, help='programs beside them')
    parser.add_argument('--style', action='append', help='only these')
    chosen = parser.parse_args()
    facts, sandbox = report.machine(), strongest()
    report.print_machine(facts)
    figures = {}
    for name, (body, scenario) in programs().items():
        if chosen.style and name not in chosen.style:
            continue
        calm = measure(body, scenario, sandbox, chosen.repeats)
        with busy(chosen.busy):
            loaded = measure(body, scenario, sandbox, chosen.repeats)
        figures[name] = {
            'runs': 2 * chosen.repeats,
            'differ': calm[0] + loaded[0],
            'calm_s': round(calm[1], 3),
            'busy_s': round(loaded[1], 3),
        }
        print(name, figures[name], file=sys.stderr, flush=True)
    rows = [[name, *one.values()] for name, one in figures.items()]
    report.print_table(['style', 'runs', 'differ', 'calm [s]', 'busy [s]'], rows)
    whole = {'repeats': chosen.repeats, 'busy': chosen.busy}
    full = chosen.repeats >= REPEATS and not chosen.style
    report.save('virtual_clock', facts, {**whole, 'styles': figures}, full=full)


if __name__ == '__main__':
    main()
