"""
Lesson 03, part 3: the courier.

The specification, as the lesson gives it: node ``courier``; a publisher of ``std_msgs/msg/String``
on ``parcels`` with depth 10; the text ``for you`` exactly once, as soon as somebody is connected.
The subscriptions come late and are volatile and reliable, so that what was published before they
came is lost, and what was published when they came is not.  The second comes while the first is
there, the third after both have left: a node that asks only whether somebody is there delivers
again.
"""

from __future__ import annotations

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Join, Leave, Look, Mark, Scenario, Step
from autograder.judging.causes.ended import why_no_message, why_silent
from autograder.judging.checks import require_field, SECOND
from autograder.judging.claims import node, offers
from autograder.recording import Event
from autograder.submission.code.learners_code import Code

NODE = '/courier'
TOPIC = '/parcels'
TYPE = 'std_msgs/msg/String'
TEXT = 'for you'
AFTER_S = 4.0  # for a node that looks around with a timer [s]
QUIET_S = 6.0  # nothing is due, and a node that repeats itself is heard [s]
ALONE_S = 2.0  # for a node that notices that everybody has left [s]
LATEST_S = 2.05  # a node that looks around every two seconds is not late yet [s]
EXERCISE = 'Exercise 2: the courier who waits'
LATE = Cause(
    'delivers_late',
    'A subscription is connected, and the parcel comes seconds later: your node does not look '
    'often enough, or waits for something else.',
    'Look every tenth of a second: self.create_timer(0.1, ...).',
)
REMEMBER = 'Remember that it was delivered: cancel the timer, or set a flag and look at it.'


def parcels(run: Run, listener: str) -> list[Event]:
    """Return what one of our subscriptions received, in order."""
    return run.recording.messages(TOPIC, listener)


def _ends(run: Run) -> list[Event]:
    """Return the publishers on the topic."""
    return run.recording.endpoints('publisher', TOPIC)


def _lives(run: Run, when: str) -> bool:
    """Return whether the graph of a moment, ``delivered`` or ``end``, has its publisher."""
    ends = [end for graph in run.recording.of('graph', when=when) for end in graph['endpoints']]
    return any(end['topic'] == TOPIC and end['kind'] == 'publisher' for end in ends)


def _why_gone(run: Run, text: str) -> Cause | None:
    """
    Explain a node that does not live on.

    :param text: when it went, if nothing has gone wrong
    """
    recording = run.recording
    if recording.process.get('exit') or recording.end_reason not in ('complete', 'student_exited'):
        return why_silent(run)
    advice = 'Let the node live on until it is stopped: self.timer.cancel() ends the search.'
    return Cause('exited_early', text, advice)


def delivers_to_who_comes_late(run: Run) -> None:
    """It waits: a subscription that comes late receives the parcel, and at once."""
    found = run.recording.phase('first').messages(TOPIC, 'first')
    # What is sent by a program that ends at once arrives, or not, by chance.
    lives = _lives(run, 'delivered')
    if found and lives:
        _require_soon(run, found[0])
        return
    if run.recording.of('joined', listener='first') and not lives:
        why = _why_gone(
            run, 'The node was gone as soon as somebody was connected, and its message with it.'
        )
    elif parcels(run, 'first') and not _came_with_the_second(run):
        why = LATE
    elif parcels(run, 'first'):
        why = Cause(
            'waits_for_two',
            'Nothing is delivered until a second subscription is there.',
            'Deliver as soon as get_subscription_count() is above 0.',
        )
    else:
        why = why_silent(run) or _why_nothing(run)
    raise Failed(
        expected='one message for a subscription that comes after some seconds',
        observed='a subscription that receives nothing' if lives else 'a node that is gone',
        why=why,
    )


def _came_with_the_second(run: Run) -> bool:
    """Return whether the first listener heard nothing until the second one came, and then did."""
    second = run.recording.of('joined', listener='second')
    found = parcels(run, 'first')
    waited_ns = found[0]['clock_ns'] - second[0]['clock_ns'] if found and second else -1
    return 0 <= waited_ns <= LATEST_S * SECOND


def _require_soon(run: Run, parcel: Event) -> None:
    """Fail if the parcel came so late that no usual timer explains it."""
    joined = run.recording.of('joined', listener='first')[0]
    late_s = (parcel['clock_ns'] - joined['clock_ns']) / SECOND
    if late_s > LATEST_S:
        raise Failed(
            expected='the parcel as soon as a subscription is connected',
            observed='a parcel that comes seconds later'
            if run.secret
            else f'a parcel that comes {late_s:.2g} s later',
            why=LATE,
        )


def _why_nothing(run: Run) -> Cause:
    """Explain a courier that is connected and lives, and from whom nothing comes."""
    code = Code(run.files)
    if 'publish' not in code.calls:
        return why_no_message(run)
    looks = {'create_timer', 'PublisherEventCallbacks'} & code.names or code.loops
    if not looks:
        return Cause(
            'published_too_early',
            'What your program does at its start, it does before anybody is connected, and '
            'nothing looks again later.',
            'Let a timer look: publish when get_subscription_count() is above 0.',
        )
    if {'get_subscription_count', 'PublisherEventCallbacks'} & code.names:
        return Cause(
            'looks_wrong',
            'Your program looks who is connected, and yet delivers nothing when somebody is: it '
            'stops looking too early, looks too seldom, or its condition is not true then.',
            'Look every tenth of a second, deliver when get_subscription_count() > 0, and cancel '
            'the timer after the delivery and not before.',
        )
    return Cause(
        'published_too_early',
        'Nothing came once somebody was connected. Most likely the parcel was published '
        'before, and what nobody receives is lost.',
        'Publish when get_subscription_count() is above 0, or in a callback for matched.',
    )


def addresses_the_parcel(run: Run) -> None:
    """The text of the parcel is: for you."""
    require_field(run, parcels(run, 'first')[:1], 'data', TEXT)


def delivers_once(run: Run) -> None:
    """It delivers exactly once: no second message, whoever else comes."""
    if any(end['qos']['durability'] != 'VOLATILE' for end in _ends(run)):
        raise Failed(
            expected='a publisher that keeps nothing for those who come later',
            observed='durability TRANSIENT_LOCAL',
            why=Cause(
                'qos_durability',
                'With this durability everybody who comes later and asks for old messages gets '
                'the parcel again.',
                'Pass the depth 10 as quality of service.',
            ),
        )
    early = sum(one['number'] - 1 for one in parcels(run, 'first')[:1])
    if early:
        raise Failed(
            expected='nothing before somebody is connected',
            observed=f'{early} before',
            why=Cause(
                'published_too_early',
                'Your program also publishes while nobody is connected, and what nobody receives '
                'is lost.',
                'Publish only when get_subscription_count() is above 0.',
            ),
        )
    listeners = ('first', 'second', 'third')
    first, second, third = (len(parcels(run, listener)) for listener in listeners)
    lives = run.recording.end_reason == 'complete' and _lives(run, 'end')
    if (first, second, third) == (1, 0, 0) and lives:
        return
    expected = '1 message for who comes first, none for those who come later'
    observed = f'{first} for the first, {second or "none"} for the second'
    if third and not second:
        expected, observed = 'none for who comes after the others have left', str(third)
    elif (first, second, third) == (1, 0, 0):
        expected, observed = 'a node that lives on after the delivery', 'a node that is gone'
    raise Failed(expected=expected, observed=observed, why=_why_again(run, first, second, third))


def _why_again(run: Run, first: int, second: int, third: int) -> Cause | None:
    """Explain more than one delivery, or a node that does not live on."""
    if run.recording.end_reason != 'complete' or not _lives(run, 'end'):
        return _why_gone(run, 'The parcel was delivered, and some time later the node was gone.')
    if why := why_silent(run):
        return why
    if first > 2 or (first > 1 and not second):
        return Cause('repeats', 'The parcel is published again and again.', REMEMBER)
    if run.recording.phase('second').messages(TOPIC, 'second'):
        return Cause('repeats', 'Who comes second receives a parcel too.', REMEMBER)
    if second or third:
        return Cause(
            'delivers_again',
            'When somebody leaves, a parcel is delivered again. How many are connected now does '
            'not tell who was there before.',
            REMEMBER,
        )
    return None


def build(alone_s: float, between_s: float = 1.0) -> Exam:
    """
    Return the exam for one late comer, one who comes later still, and one when both have left.

    :param alone_s: before the first comes [s]
    :param between_s: before the second comes, when the parcel has been delivered [s]
    """
    steps: tuple[Step, ...] = (
        Advance(alone_s),
        # Of another type, so it is there and not connected.
        Join('stranger', TOPIC, 'std_msgs/msg/Int32'),
        Leave('stranger'),
        Mark('first'),
        Join('first', TOPIC, TYPE),
        Advance(AFTER_S),
        Look('delivered'),
        Advance(between_s),
        Mark('second'),
        Join('second', TOPIC, TYPE),
        Advance(QUIET_S),
        Mark('third'),
        Leave('first'),
        Leave('second'),
        Advance(ALONE_S),
        Join('third', TOPIC, TYPE),
        Advance(AFTER_S),
    )
    exam = Exam(
        'courier',
        title='The courier',
        assignment='03_topics',
        part=2,
        scenario=Scenario(file='courier.py', steps=steps),
        read='Part 3: Discovery takes time',
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=1, read='Part 1: Speaking and listening')(
        offers(TOPIC, TYPE, 'offers_parcels', 'It has a publisher of String messages on parcels.')
    )
    exam.check(points=4, needs=['offers_parcels'])(delivers_to_who_comes_late)
    for points, judge, read in (
        (1, addresses_the_parcel, EXERCISE),
        (3, delivers_once, ''),
    ):
        exam.check(points=points, needs=['delivers_to_who_comes_late'], read=read)(judge)
    return exam


exam = build(alone_s=4.0)
