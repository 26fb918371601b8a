"""
Lesson 03, part 2: the talker.

Specification from the lesson: node ``talker``; a ``std_msgs/msg/String`` twice a second on the
relative topic ``chatter``; texts ``hello 1``, ``hello 2`` and so on; quality of service reliable
and volatile, which is the default with depth 10.  The node is started in a namespace.

The probe subscribes to ``chatter`` in the namespace, after a while, and to the absolute
``/chatter``, so that an absolute name fails its own check and no others.  The second
start is in the root namespace; there, the subscription leaves and returns.
"""

import re

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.steps import Advance, get_parameters, Join, unheard
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_it_ended, why_silent
from autograder.judging.causes.text_table import cause_of
from autograder.judging.checks import counted, require_messages, require_qos
from autograder.judging.claims import node
from autograder.judging.numbers import why_not_numbered
from autograder.judging.rhythm import just_before, require_period, seconds_between, with_unheard
from autograder.recording import Event, SECOND
from autograder.results import shortened

TYPE = 'std_msgs/msg/String'
ABSOLUTE = '/chatter'
PERIOD_S = 0.5
GUEST_S = 0.2  # duration of a join, or of a call [s]
UNHEARD_S = 1.2  # without a subscription: at the start, and in the root namespace [s]
ROOT_S = 5.0  # in the root namespace, twice: enough for a node that publishes too rarely [s]
STOPS_S = 1.0  # at most, from the last message to the moment at which all subscriptions leave [s]
WAITS_S = 1.0  # additional time if there is no publisher, or no service of that name [s]
GREETING = re.compile(r'hello (\d{1,9})')
EXERCISE = 'Exercise 1: a talker that can move'
WHY = Causes(__file__, ABSOLUTE=ABSOLUTE)


def heard_on(run: Run) -> str:
    """Return the topic to judge: the absolute one if only it has a publisher."""
    right, ends = run.facts['topic'], run.recording.endpoints
    wrong = not ends('publisher', right) and ends('publisher', ABSOLUTE)
    return ABSOLUTE if wrong else right


def greetings(run: Run) -> list[Event]:
    """Return the messages on the judged topic, in order."""
    return [event for event in run.recording.messages(heard_on(run)) if 'data' in event]


def publishes_greetings(run: Run) -> None:
    """It publishes String messages on chatter."""
    require_messages(run, greetings(run), 1, 'messages on chatter', topic=heard_on(run))


def moves_with_its_namespace(run: Run) -> None:
    """Its topic is relative: it moves along with the namespace of the node."""
    if heard_on(run) != run.facts['topic']:
        raise WHY.failed('absolute_name')


def speaks_in_the_root(run: Run) -> None:
    """Without a namespace, its topic is /chatter; it speaks on when all subscriptions leave."""
    found = run.recording.messages(ABSOLUTE)
    require_messages(run, found, 1, f'messages on {ABSOLUTE}', topic=ABSOLUTE)
    last_ns = found[-1]['clock_ns']
    # If a node has stopped before, a different check reports it.
    if any(0 <= one['clock_ns'] - last_ns < STOPS_S * SECOND for one in run.recording.of('left')):
        raise Failed(
            expected='messages for a subscription that connects after all others have left',
            observed='no such message',
            why=why_it_ended(run) or cause_of('stops', what='message'),
        )


def speaks_twice_a_second(run: Run) -> None:
    """It publishes twice a second, even while nothing subscribes."""
    found = with_unheard(run, run.recording.messages(heard_on(run)))
    missing = run.recording.of('joined', matched=False) + run.recording.of('no_answer')
    if run.facts['node'] not in run.recording.nodes:
        missing += run.recording.of('answer')
    during_s = run.facts['seconds'] + WAITS_S * len(missing)
    waited_s = seconds_between(run.recording.of('seen'), found)
    require_period(run, found, PERIOD_S, during_s, waited_s=waited_s)


def counts_its_greetings(run: Run) -> None:
    """The texts are hello 1, hello 2 and so on, without gaps."""
    found, least = greetings(run), int(run.facts['seconds'] - UNHEARD_S) // 2
    if len(found) < least:
        messages = counted(len(found), 'message')
        raise WHY.failed('wrong_rate', why_silent(run), least=least, messages=messages)
    texts = [str(event['data']['data']) for event in found]
    # Greetings sent before the subscription connected are lost, so the count may begin above 1.
    first = found[0]['number']
    for place, text in enumerate(texts):
        due = first + place
        if text != f'hello {due}':
            raise Failed(
                expected=f"the text 'hello {due}' in message {due}",
                observed=repr(shortened(text)),
                why=_why_text(
                    texts, place, first, just_before(run, found, place) if place else ''
                ),
            )


def _why_text(texts: list[str], place: int, first: int, when: str) -> Cause | None:
    written = GREETING.fullmatch(texts[place])
    right = written and int(written[1]) == first + place
    if '{' in texts[place] or (written and not right):
        return why_not_numbered(texts, place, first, when)
    return WHY.of('wrong_text', about=[texts[place]])


def offers_reliable_qos(run: Run) -> None:
    """Its quality of service is reliable and volatile, the default with depth 10."""
    ends = run.recording.endpoints('publisher', heard_on(run))
    require_qos(ends, reliability='RELIABLE', durability='VOLATILE', lifespan_ns=None)


def build(space: str, seconds: float, comes: bool = False) -> Exam:
    """
    Return the exam for one namespace.

    :param space: namespace in which the node is started, such as ``/lab``
    :param seconds: duration of the recording [s]
    :param comes: whether another subscription joins, and a service is called, halfway through
    """
    # Neither event should change the messages, but each ends the pause of a spin_once() loop.
    name, topic = f'{space}/talker', f'{space}/chatter'
    guest = Join('guest', topic, TYPE, listen_s=0.0)
    call = get_parameters(name, patience_s=GUEST_S)
    visits = (guest, call) if comes else ()
    leaves = (Advance(ROOT_S), *unheard(ABSOLUTE, UNHEARD_S), Advance(ROOT_S))
    root = Scenario(file='talker.py', watch={ABSOLUTE: TYPE}, steps=leaves)
    exam = Exam(
        'talker',
        title='The talker',
        assignment='03_topics',
        part=1,
        scenario=Scenario(
            file='talker.py',
            arguments=('-r', f'__ns:={space}'),
            watch={topic: TYPE, ABSOLUTE: TYPE},
            steps=(
                *unheard(topic, UNHEARD_S),
                Advance(seconds / 2 - UNHEARD_S - GUEST_S),
                *visits,
                Advance(seconds / 2 - GUEST_S * len(visits)),
            ),
            again=root,
        ),
        read='Part 2: Names',
        facts={'node': name, 'topic': topic, 'seconds': seconds},
    )
    exam.check(points=1)(
        node(
            name,
            sentence='Your program starts a node called talker, in the namespace it was given.',
        )
    )
    exam.check(points=2, read='Part 1: Speaking and listening')(publishes_greetings)
    needs, part_2 = ['publishes_greetings'], 'lesson 02, When a timer ticks'
    exam.check(points=2, needs=needs)(moves_with_its_namespace)
    exam.check(points=1, needs=['moves_with_its_namespace'], again=True)(speaks_in_the_root)
    exam.check(points=2, needs=needs, read=part_2)(speaks_twice_a_second)
    exam.check(points=1, needs=needs, read=EXERCISE)(counts_its_greetings)
    exam.check(points=1, needs=needs, read='lesson 05, Part 1: A profile')(offers_reliable_qos)
    return exam


exam = build('/lab', seconds=6.0)
