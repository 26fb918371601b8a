"""
Lesson 06, part 2: a beacon as a lifecycle node.

Specification from the lesson: lifecycle node ``beacon``; ``on_configure`` creates a publisher of
``std_msgs/msg/String`` on ``beacon_signal``; while active, the node publishes once per second,
otherwise nothing; ``on_cleanup`` destroys the publisher, so that the node can be configured again.
The command line sets the namespace; the second start is in the root namespace, and there the
beacon is cleaned up before it was ever active.
"""

from collections.abc import Sequence

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.steps import (
    Advance,
    Join,
    Leave,
    Look,
    Mark,
    Qos,
    state,
    Step,
    transition,
    Watch,
)
from autograder.exam.words import Causes
from autograder.judging.causes.ended import (
    why_no_message,
    why_no_method,
    why_refused,
    why_silent,
)
from autograder.judging.checks import (
    counted,
    require_answers,
    require_endpoint,
    require_partner,
)
from autograder.judging.claims import node
from autograder.judging.rhythm import require_period, seconds_between, with_unheard
from autograder.judging.rows import publishers_at
from autograder.recording import Event
from autograder.submission.code.source_code import Code

TYPE = 'std_msgs/msg/String'
WAYS = ('configure', 'activate', 'deactivate', 'activate', 'deactivate', 'cleanup')
ASKED = (*WAYS, 'configure', 'activate')
UNUSED = ('configure', 'cleanup', 'configure')
"""Transitions of the second start, which clean up a configuration that was never active."""
SILENT = ('unconfigured', 'configured', 'paused', 'cleaned', 'configured again')
ACTIVE = ('active', 'active again')
UNHEARD_S = 1.2  # in the first active phase, without a subscription [s]
EXERCISE = 'Exercise 1: a managed beacon'

WHY = Causes(__file__)


def publishers(run: Run, when: str) -> list[Event]:
    """Return the publishers on the topic in a graph of the recording, given its label."""
    return publishers_at(run, when, run.facts['topic'])


def is_managed(run: Run) -> None:
    """It is a lifecycle node, and it starts in the state unconfigured."""
    wanted = {'current_state.label': 'unconfigured'}
    service, what = f'{run.facts["node"]}/get_state', 'the request for its state'
    require_answers(run, service, [wanted], what, explain=lambda place: WHY['acts_alone'])


def creates_its_publisher(run: Run) -> None:
    """It creates the publisher on beacon_signal when it is configured, and not earlier."""
    if not publishers(run, 'configured'):
        _require_transitions(run, ASKED[:1], run.facts['node'])
    require_partner(require_endpoint(run, 'publisher', run.facts['topic'], TYPE))
    if publishers(run, 'unconfigured'):
        raise WHY.failed('published_too_early')
    if not publishers(run, 'configured'):
        raise WHY.failed('too_late', why_silent(run))


def takes_every_transition(run: Run) -> None:
    """It carries out every requested transition, in two rounds."""
    _require_transitions(run, ASKED, run.facts['node'])


def _require_transitions(
    run: Run,
    asked: Sequence[str],
    beacon: str,
    what: str = 'the transitions configure, activate, deactivate and cleanup',
) -> None:
    """Fail unless the first requested transitions of a node succeed."""
    require_answers(
        run,
        f'{beacon}/change_state',
        [{'success': True}] * len(asked),
        what,
        explain=lambda place: why_refused(run, asked[place], again=asked[place] in asked[:place]),
    )


def publishes_while_active(run: Run) -> None:
    """While active, it publishes once a second."""
    first, again = ACTIVE
    _require_beat(run, first, None, None)
    _require_beat(run, again, WHY['mute_again'], WHY['timer_left'])


def _require_beat(run: Run, phase: str, why_none: Cause | None, why_more: Cause | None) -> None:
    """
    Fail unless the node publishes once per second in an active phase.

    :param why_none: cause if there are no messages; None to find it in the code
    :param why_more: cause if there are too many messages; None to find it in their rhythm
    """
    part, active_s = run.recording.phase(phase), run.facts['active_s']
    found = part.messages(run.facts['topic'])
    if not found:
        require_endpoint(run, 'publisher', run.facts['topic'], TYPE)
        raise Failed(
            expected=f'messages on beacon_signal while the node is {phase}',
            observed='no message',
            why=why_silent(run) or why_none or why_no_message(run),
        )
    at_once = [one for one in found if one['clock_ns'] == found[0]['clock_ns']]
    later = len(at_once) > 1 and len(found) - len(at_once) <= active_s
    more = WHY['sent_later'] if later else why_more if len(found) > active_s + 1 else None
    when = f' while the node is {phase}'
    begins_ns = part.of('mark')[0]['clock_ns']
    found = [one for one in with_unheard(run, found) if one['clock_ns'] >= begins_ns]
    waited_s = seconds_between(part.of('mark'), found)
    require_period(run, found, 1.0, active_s, 'message', lambda: more, when, waited_s)


def is_silent_otherwise(run: Run) -> None:
    """In any other state it publishes nothing."""
    for phase in SILENT:
        found = run.recording.phase(phase).messages(run.facts['topic'])
        paused = phase == 'paused'
        if found:
            raise WHY.failed(
                'stays_on' if paused else 'not_managed',
                why_no_method(Code(run.files), 'on_deactivate') if paused else None,
                messages=counted(len(found), 'message'),
                phase=phase,
            )
    kept = run.recording.messages(run.facts['topic'], 'latecomer')
    if kept:
        raise WHY.failed('keeps_old', messages=counted(len(kept), 'message'))


def cleans_up(run: Run) -> None:
    """Cleanup destroys the publisher, and the next configuration creates a new one."""
    if left := len(publishers(run, 'cleaned')):
        raise WHY.failed('not_cleaned', publishers=counted(left, 'publisher'))
    again = len(publishers(run, 'configured again'))
    if again != 1:
        raise Failed(
            expected='one publisher after the node was configured again',
            observed=f'{again} publishers' if again else 'no publisher',
            why=why_silent(run)
            or (WHY['configured_once'] if publishers(run, 'configured') else WHY['too_late']),
        )
    _require_beat(run, 'active after cleanup', WHY['mute_after_cleanup'], WHY['not_cleaned'])


def cleans_up_unused(run: Run) -> None:
    """Without a namespace, too, it can be configured, and cleaned up before it is ever active."""
    _require_transitions(run, UNUSED, '/beacon', 'the transitions configure and cleanup')


def build(namespace: str = '', seconds: float = 4.0) -> Exam:
    """Return the exam with active phases of some seconds, in a namespace such as ``/lab``."""
    name, topic = f'{namespace}/beacon', f'{namespace}/beacon_signal'
    # Add some hundredths of a second, so that no transition falls exactly on a tick of a timer
    # that an earlier transition started: at such a moment, either may be first.
    pause, work = Advance(2.03), Advance(seconds + 0.05)
    alone, rest = Advance(UNHEARD_S), Advance(seconds + 0.05 - UNHEARD_S)
    changes = {way: transition(name, way) for way in WAYS}
    configure, activate = changes['configure'], changes['activate']
    deactivate, cleanup = changes['deactivate'], changes['cleanup']
    steps: list[Step] = [
        *(Mark('unconfigured'), state(name), pause, Look('unconfigured')),
        *(Mark('configured'), configure, pause, Look('configured')),
        *(Leave(topic), Mark('active'), activate, alone, Watch(topic), rest),
        *(Mark('paused'), deactivate, pause),
        *(Join('latecomer', topic, TYPE, Qos(durability='TRANSIENT_LOCAL')), Leave('latecomer')),
        *(Mark('active again'), activate, work),
        *(Mark('cleaned'), deactivate, cleanup, pause, Look('cleaned')),
        *(Mark('configured again'), configure, pause, Look('configured again')),
        *(Mark('active after cleanup'), activate, work),
    ]
    unused = (pause, *(transition('/beacon', way) for way in UNUSED))
    exam = Exam(
        'managed_beacon',
        title='The managed beacon',
        assignment='06_managed_lifecycle',
        part=2,
        scenario=Scenario(
            file='managed_beacon.py',
            arguments=('-r', f'__ns:={namespace}') if namespace else (),
            watch={topic: TYPE},
            steps=steps,
            again=Scenario(file='managed_beacon.py', steps=unused),
        ),
        read='Part 2: A publisher with a switch',
        facts={'node': name, 'topic': topic, 'active_s': seconds},
    )
    named = 'Your program starts a node called beacon, in the namespace it is given.'
    exam.check(points=1, read=EXERCISE)(node(name, sentence=named, only_named=True))
    exam.check(points=1, needs=['starts_its_node'], read='Part 1: Two kinds of life')(is_managed)
    exam.check(points=1, needs=['is_managed'])(takes_every_transition)
    exam.check(points=1, needs=['takes_every_transition'], again=True)(cleans_up_unused)
    exam.check(points=2, needs=['is_managed'])(creates_its_publisher)
    exam.check(points=2, needs=['takes_every_transition'])(publishes_while_active)
    exam.check(points=1, needs=['publishes_while_active'])(is_silent_otherwise)
    exam.check(points=1, needs=['publishes_while_active'], read=EXERCISE)(cleans_up)
    return exam


exam = build()
