"""
Lesson 01, first exercise: two nodes in one program.

The specification, as the lesson gives it: the nodes ``lookout`` and ``keeper`` in the namespace
``harbour``; the first logs one INFO line a second and the second one every two seconds, each from
a timer and with its own logger; one executor serves both.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
import re

from autograder.judging.causes import why_it_ended, why_no_node, why_silent
from autograder.judging.checks import OTHER_CLOCK, own_logs, SECOND, why_own_time
from autograder.judging.code_periods import timer_periods
from autograder.judging.exam import Cause, Exam, Failed, Run
from autograder.judging.own_time import names_another_clock, SHORTEST_S
from autograder.judging.unlogged import debug_level, why_left_out, why_not_logged
from autograder.runs.recording import Event, INFO
from autograder.runs.scenario import Advance, Await, Scenario

NAMESPACE = '/harbour'
LOOKOUT, KEEPER = f'{NAMESPACE}/lookout', f'{NAMESPACE}/keeper'
STEP_S = 0.25
OTHER_SPUN = Cause(
    'other_node_spun',
    'Nobody spins that node. rclpy.spin(node) serves one node and does not come back, so a second '
    'call of it is never reached.',
    'Make one executor, add both nodes with add_node(), and call executor.spin().',
)
NEITHER_SPUN = Cause(
    'never_spun',
    'Nobody serves the two nodes: no executor spins, or a loop or a sleep holds it up, and no '
    'timer can call anything.',
    'Make one executor, add both nodes with add_node(), and call executor.spin() instead.',
)
EXERCISE = 'Exercise 1: two nodes, one program'


def both_nodes_exist(run: Run) -> None:
    """One program has the nodes lookout and keeper, in the namespace harbour."""
    for node in (LOOKOUT, KEEPER):
        if node not in run.recording.nodes:
            raise Failed(
                expected=f'a node called {node.rpartition("/")[2]} in the namespace {NAMESPACE}',
                observed=', '.join(name[:60] for name in run.recording.nodes[:5]) or 'no node',
                why=_why_missing(run, node),
            )


def _why_missing(run: Run, node: str) -> Cause:
    """Explain why one of the two nodes is not there."""
    base = node.rpartition('/')[2]
    others = [name for name in run.recording.nodes if name not in (LOOKOUT, KEEPER)]
    for name in others:
        space, _, last = name.rpartition('/')
        if last == base:
            return Cause(
                'namespace',
                f'Your node {base} is in '
                + (f'the namespace {space}.' if space else 'no namespace.'),
                "Pass it to the parent class: super().__init__(name, namespace='harbour').",
            )
    if run.recording.nodes and not others:
        return why_silent(run) or Cause(
            'one_node',
            f'The other node is there, and {base} is not: either it is created below '
            'rclpy.spin(), which does not come back, or both nodes got the same name.',
            'Create both nodes first, each with its own name; then let one executor spin both.',
        )
    return why_no_node(run, node)


def both_are_served(run: Run) -> None:
    """Somebody spins both nodes: each answers when it is asked."""
    answered = {event['node'] for event in run.recording.of('barrier', answered=True)}
    silent = [node for node in (LOOKOUT, KEEPER) if node not in answered]
    if silent:
        raise Failed(
            expected='both nodes answer a question about their parameters',
            observed=f'no answer from {" and ".join(silent)}',
            why=OTHER_SPUN if len(silent) == 1 else NEITHER_SPUN,
        )


def lookout_reports_every_second(run: Run) -> None:
    """The lookout logs one INFO line a second."""
    require_reports(run, LOOKOUT, 1)


def keeper_reports_every_two_seconds(run: Run) -> None:
    """The keeper logs one INFO line every two seconds."""
    require_reports(run, KEEPER, 2)


def second_of(entry: Event) -> int:
    """
    Return the second of simulated time to which a log line belongs; 0 for one of the start.

    A timer fires on the first clock step at or after its time: half a second later at most.
    """
    return round((entry['clock_ns'] or 0) / SECOND - STEP_S)


def _watched_s(run: Run) -> int:
    """Return for how many seconds of the clock lines are due where another node keeps its own."""
    shown = (run.recording.of('end')[-1]['clock_ns'] or 0) / SECOND
    # The clock waits for answers: who gives them slowly would have to show next to nothing.
    return int(max(shown, SHORTEST_S))


def require_reports(run: Run, node: str, period_s: int) -> None:
    """
    Fail unless a node logs one INFO line a period of simulated time, and nothing else.

    What it says when it starts does not count, and neither does in which second it begins.

    :param node: full name
    """
    alone = run.recording.goes_on_alone
    own = run.recording.by_another_clock(node.strip('/').replace('/', '.'))
    if own or (run.recording.in_wall_time and not alone):
        raise Failed(
            expected='lines in the rhythm of the simulated clock',
            observed='a program with a clock of its own',
            why=why_own_time(run) if own else NEITHER_SPUN,
        )
    seconds = _watched_s(run) if alone else run.facts['simulated_s']
    entries = [entry for entry in own_logs(run, node) if second_of(entry) > 0]
    lines = [entry for entry in entries if entry['level'] == INFO]
    seen = [second_of(line) for line in lines]
    # In real time, the last line may be one that is just due.
    for until in (seconds, seconds - 1) if alone else (seconds,):
        if any(
            seen == list(range(first, until + 1, period_s)) for first in range(1, period_s + 1)
        ):
            return
    require_timer(run)
    raise Failed(
        expected=f'{seconds // period_s} INFO lines from {node} in {seconds} s, '
        f'one every {period_s} s',
        observed=f'{len(seen) or "no"} INFO lines',
        why=_why_other_rhythm(run, lines, seen, period_s)
        if seen
        else _why_no_report(run, node, entries, period_s),
    )


def require_timer(run: Run) -> None:
    """
    Fail with the reason if the lines of a program follow another clock.

    How many of them then come in simulated time is luck, so no text tells their number.
    """
    code = '\n'.join(run.files.values())
    timer = 'create_timer' in code or 'create_rate' in code
    if why_it_ended(run):
        return
    if names_another_clock(run.files) and (not timer or '_TIME' in code):
        raise Failed(
            expected='lines from a timer of the node, in the rhythm of its clock',
            observed='lines in another rhythm',
            why=OTHER_CLOCK,
        )


def _why_no_report(run: Run, node: str, entries: Sequence[Event], period_s: int) -> Cause | None:
    """Explain a node without any report."""
    if not run.recording.of('barrier', node=node, answered=True):
        return OTHER_SPUN
    return why_not_logged(run, entries, INFO) or why_no_report(run, period_s)


def why_no_report(run: Run, period_s: int) -> Cause:
    """
    Explain a node that is served, lives on and logs nothing.

    :param period_s: in which it should have logged one line [s]
    """
    code = '\n'.join(run.files.values())
    call = f'self.create_timer({period_s}.0, self.report)'
    if 'create_timer' not in code and 'create_rate' not in code:
        return Cause('no_timer', 'No timer is created, so nothing is called.', f'Call {call}.')
    if '.debug(' in code:
        return debug_level(INFO)
    if re.search(r'except\s*:|except\s+(Base)?Exception\b', code):
        return Cause(
            'swallowed',
            'Nothing is logged, and your code catches every exception: a mistake in the callback '
            'is told to nobody.',
            'Take try and except out of the callback, and read what Python says.',
        )
    return Cause(
        'silent',
        f'The node runs for {run.facts["simulated_s"]} s, and none of its timers leads to a '
        'line: it has not been created, or its period is too long, or its callback does not log.',
        f'Is {call} reached? The period is in seconds: 1000 is a quarter of an hour.',
    )


def _why_other_rhythm(
    run: Run, lines: Sequence[Event], seen: Sequence[int], period_s: int
) -> Cause | None:
    """Explain reports at other moments than those that are due."""
    seconds = run.facts['simulated_s']
    if len(seen) < seconds // period_s and (why := why_silent(run) or why_left_out(run, INFO)):
        return why
    return why_other_period(run, lines, period_s)


def why_other_period(run: Run, lines: Sequence[Event], period_s: int) -> Cause | None:
    """
    Explain lines that come too often or too rarely.

    :param lines: at least one, in order
    """
    seconds = run.facts['simulated_s']
    moments = {line['clock_ns'] for line in lines}
    if len(moments) < len(lines) and len(moments) <= seconds // period_s + 1:
        return Cause(
            'several_at_once',
            'Several lines come at the same moment.',
            'Make one timer only, and log one line in its callback.',
        )
    if len(lines) == seconds // period_s:
        return None
    clocks_s = [(line['clock_ns'] or 0) / SECOND for line in lines]
    gaps = [later - earlier for earlier, later in pairwise(clocks_s)]
    right = f'The first argument of create_timer() is the period in seconds: {period_s}.0.'
    # A single line has no rate, and neither have lines that come now and then.
    if gaps and max(gaps) - min(gaps) <= 2 * STEP_S:
        mean_s = sum(gaps) / len(gaps)
        if abs(mean_s - period_s) > STEP_S / 2:
            return Cause('wrong_rate', f'There is about one line every {mean_s:.2g} s.', right)
    periods = timer_periods(run.files)
    if periods and period_s not in periods:
        return Cause('wrong_rate', 'No timer in your code has this period.', right)
    return None


def build(seconds: int, phase_s: float) -> Exam:
    """
    Return the exam over some simulated time.

    :param seconds: simulated seconds, >= 5
    :param phase_s: first clock value, 0 < phase_s < 0.25 [s]
    """
    exam = Exam(
        'harbour',
        title='Two nodes, one program',
        assignment='01_node_life',
        part=1,
        cells=('harbour',),
        requires=('harbour.py',),
        scenario=Scenario(
            file='harbour.py',
            steps=(
                Advance(1.5, phase_s=phase_s),
                Await(logs=1),
                Advance(seconds - 1.0, phase_s=STEP_S),
            ),
        ),
        read='Part 3: Names and worlds',
        facts={'simulated_s': seconds},
    )
    exam.check(points=2)(both_nodes_exist)
    exam.check(points=2, needs=['both_nodes_exist'], read='lesson 02, Part 1: Who spins')(
        both_are_served
    )
    exam.check(points=2, needs=['both_nodes_exist'], read=EXERCISE)(lookout_reports_every_second)
    exam.check(points=2, needs=['both_nodes_exist'], read=EXERCISE)(
        keeper_reports_every_two_seconds
    )
    return exam


exam = build(seconds=8, phase_s=0.1)
