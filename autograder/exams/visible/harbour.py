"""
Lesson 01, first exercise: two nodes in one program.

The specification, as the lesson gives it: the nodes ``lookout`` and ``keeper`` in the namespace
``harbour``; the first logs one INFO line a second and the second one every two seconds, each from
a timer and with its own logger; one executor serves both.
"""

from __future__ import annotations

from autograder.causes import why_silent
from autograder.checks import (
    own_logs,
    OWN_LOOP,
    require_node,
    require_ros_clock,
    SECOND,
    why_not_logged,
)
from autograder.exam import Cause, Exam, Failed, Run
from autograder.recording import INFO
from autograder.scenario import Advance, Await, Scenario

LOOKOUT, KEEPER = '/harbour/lookout', '/harbour/keeper'
STEP_S = 0.25
NOT_SPUN = Cause(
    'not_spun',
    'Nobody spins that node. rclpy.spin(node) serves one node and does not come back, so a second '
    'call of it is never reached.',
    'Make one executor, add both nodes with add_node(), and call executor.spin().',
)


def both_nodes_exist(run: Run) -> None:
    """One program has the nodes lookout and keeper, in the namespace harbour."""
    for node in (LOOKOUT, KEEPER):
        outside = node.removeprefix('/harbour')
        if node not in run.recording.nodes and outside in run.recording.nodes:
            raise Failed(
                expected=f'the node {node}',
                observed=', '.join(name[:60] for name in run.recording.nodes[:5]),
                why=Cause(
                    'namespace',
                    f'Your node {outside[1:]} is in no namespace.',
                    "Pass it to the parent class: super().__init__(name, namespace='harbour').",
                ),
            )
        require_node(run, node)


def both_are_served(run: Run) -> None:
    """Somebody spins both nodes: each answers when it is asked."""
    answered = {event['node'] for event in run.recording.of('barrier', answered=True)}
    silent = [node for node in (LOOKOUT, KEEPER) if node not in answered]
    if silent:
        raise Failed(
            expected='both nodes answer a question about their parameters',
            observed=f'no answer from {" and ".join(silent)}',
            why=NOT_SPUN if len(silent) == 1 else OWN_LOOP,
        )


def lookout_reports_every_second(run: Run) -> None:
    """The lookout logs one INFO line a second."""
    require_reports(run, LOOKOUT, 1)


def keeper_reports_every_two_seconds(run: Run) -> None:
    """The keeper logs one INFO line every two seconds."""
    require_reports(run, KEEPER, 2)


def require_reports(run: Run, node: str, period_s: int) -> None:
    """
    Fail unless a node logs one INFO line a period of simulated time, and nothing else.

    :param node: full name
    """
    require_ros_clock(run)
    seconds = run.facts['simulated_s']
    entries = own_logs(run, node)
    found = [entry['clock_ns'] for entry in entries if entry['level'] == INFO]
    due = [period_s * number for number in range(1, int(seconds // period_s) + 1)]
    # A timer fires on the first clock step at or after its time, and is seen one step later.
    seen = [round((clock or 0) / SECOND - STEP_S) for clock in found]
    if seen == due:
        return
    served = run.recording.of('barrier', node=node, answered=True)
    why = why_not_logged(run, entries, INFO) if not found and served else None
    if not found and not served:
        why = NOT_SPUN
    if found and len(found) < len(due):
        why = why_silent(run)
    if found and not why and len(found) != len(due):
        rate = seconds / len(found)
        why = Cause(
            'wrong_period',
            f'There is about one line every {rate:.2g} s.',
            f'The first argument of create_timer() is the period in seconds: {period_s}.0.',
        )
    raise Failed(
        expected=f'{len(due)} INFO lines from {node} in {seconds:g} s, one every {period_s} s',
        observed=f'{len(found) or "no"} INFO lines',
        why=why,
    )


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
    exam.check(points=2, needs=['both_nodes_exist'])(both_are_served)
    exam.check(points=2, needs=['both_nodes_exist'])(lookout_reports_every_second)
    exam.check(points=2, needs=['both_nodes_exist'])(keeper_reports_every_two_seconds)
    return exam


exam = build(seconds=8, phase_s=0.1)
