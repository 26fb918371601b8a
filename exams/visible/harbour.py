"""
Lesson 01, first exercise: two nodes in one program.

Specification from the lesson: the nodes ``lookout`` and ``keeper`` in the namespace ``harbour``;
the first logs one INFO line per second and the second logs one every two seconds, each with its
own logger; one executor serves both.
"""

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.steps import Advance, get_parameters, Mark
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_no_node, why_silent
from autograder.judging.causes.missing_logs import why_left_out, why_not_logged, why_printed
from autograder.judging.causes.text_table import why_by_code
from autograder.judging.checks import own_logs, why_other_namespace
from autograder.judging.rhythm import require_period, seconds_between
from autograder.recording import INFO

NAMESPACE = '/harbour'
LOOKOUT, KEEPER = f'{NAMESPACE}/lookout', f'{NAMESPACE}/keeper'
WATCH = 'watch'  # the phase in which log lines are judged, which excludes start-up
EXERCISE = 'Exercise 1: two nodes, one program'
BOTH = 1.5
"""Log lines per second of both nodes together [1/s]."""

WHY = Causes(__file__)


def both_nodes_exist(run: Run) -> None:
    """One program has the nodes lookout and keeper, in the namespace harbour."""
    for node in (LOOKOUT, KEEPER):
        if node not in run.recording.nodes:
            raise Failed(
                expected=f'a node called {node.rpartition("/")[2]} in the namespace {NAMESPACE}',
                observed=', '.join(name[:60] for name in run.recording.nodes[:5]) or 'no node',
                why=_why_missing(run, node),
            )
    if others := [name for name in run.recording.nodes if name not in (LOOKOUT, KEEPER)]:
        raise WHY.failed('further_node', name=others[0])
    ends = run.recording.endpoints('publisher', '/rosout')
    if len({end['process'] for end in ends if end['node'] in (LOOKOUT, KEEPER)}) > 1:
        raise WHY.failed('two_processes')


def _why_missing(run: Run, node: str) -> Cause:
    """Explain why one of the two nodes does not exist."""
    base = node.rpartition('/')[2]
    repair = "Pass it to the parent class: super().__init__(name, namespace='harbour')."
    if why := why_other_namespace(run, node, repair):
        return why
    if run.recording.nodes and not {*run.recording.nodes} - {LOOKOUT, KEEPER}:
        other = run.recording.nodes[0]
        if any(graph['nodes'].count(other) > 1 for graph in run.recording.of('graph')):
            name = other.rpartition('/')[2]
            return WHY.of('same_name', about=[name], other=name)
        return why_silent(run) or WHY.of('one_node', base=base)
    return why_no_node(run, node)


def both_are_served(run: Run) -> None:
    """Your program spins both nodes: each answers a request."""
    answered = {event['service'].rpartition('/')[0] for event in run.recording.of('answer')}
    answered |= {event['node'] for event in run.recording.of('asked', answered=True)}
    silent = [node for node in (LOOKOUT, KEEPER) if node not in answered]
    if silent:
        raise Failed(
            expected='both nodes answer a request about their parameters',
            observed=f'no answer from {" and ".join(silent)}',
            why=why_silent(run),
        )


def lookout_reports_every_second(run: Run) -> None:
    """The lookout logs one INFO line a second."""
    _require_reports(run, LOOKOUT, 1)


def keeper_reports_every_two_seconds(run: Run) -> None:
    """The keeper logs one INFO line every two seconds."""
    _require_reports(run, KEEPER, 2)


def _require_reports(run: Run, node: str, period_s: int) -> None:
    """Fail unless a node logs one INFO line per period."""
    watch, seconds = run.during(WATCH), run.facts['seconds']
    lines = own_logs(watch, node, INFO)
    # The first line may precede the phase.
    waited_s = seconds_between(run.recording.of('seen'), own_logs(run, node, INFO))

    def explain() -> Cause | None:
        counts = [len(own_logs(watch, one, INFO)) for one in (LOOKOUT, KEEPER)]
        if 0 in counts and abs(sum(counts) - BOTH * seconds) <= 2:
            return WHY['other_node_logs']
        if not lines:
            return (
                why_not_logged(run, own_logs(watch, node), INFO)
                or why_printed(run, INFO, bool, due=seconds / period_s)
                or why_left_out(run, INFO, own_logs(run, node, INFO))
                or why_by_code(
                    'no_line', run, call=f'self.create_timer({period_s}.0, self.report)'
                )
            )
        few = len(lines) < seconds // period_s or waited_s > period_s
        every = own_logs(watch, node)
        others = [one for one in every if one['level'] != INFO]
        if few and others and abs(len(every) - seconds / period_s) <= 1.5:
            return why_not_logged(run, others, INFO)
        return why_left_out(run, INFO, lines) if few else None

    require_period(run, lines, period_s, seconds, 'INFO line', explain, waited_s=waited_s)


def build(seconds: int) -> Exam:
    """Return the exam for a given duration of the phase that is judged."""
    asked = [get_parameters(node, patience_s=3.0) for node in (LOOKOUT, KEEPER)]
    exam = Exam(
        'harbour',
        title='Two nodes, one program',
        assignment='01_node_life',
        part=1,
        scenario=Scenario(file='harbour.py', steps=(*asked, Mark(WATCH), Advance(seconds))),
        read='Part 3: Names and worlds',
        facts={'seconds': seconds},
    )
    needs = ['both_nodes_exist']
    exam.check(points=2)(both_nodes_exist)
    exam.check(points=2, needs=needs, read='lesson 02, Part 1: Who spins')(both_are_served)
    exam.check(points=2, needs=needs, read=EXERCISE)(lookout_reports_every_second)
    exam.check(points=2, needs=needs, read=EXERCISE)(keeper_reports_every_two_seconds)
    return exam


exam = build(seconds=8)
