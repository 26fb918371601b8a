"""
Lesson 03, part 3: the courier.

Specification from the lesson: node ``courier``; a publisher of ``std_msgs/msg/String`` on
``parcels`` with depth 10; the text ``for you`` exactly once, as soon as a subscription is
connected.

The subscriptions of the probe join late and are volatile and reliable, so they receive only
messages published after they joined.  The second joins while the first is connected, the third
after both have left: a node that only checks whether any subscription exists delivers again.
After a second start, two subscriptions join in the same moment.
"""

from collections.abc import Sequence

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.steps import Advance, Join, Leave, Look, Mark, Step
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_no_message, why_silent, why_thread_ended
from autograder.judging.checks import counted, require_field
from autograder.judging.claims import node, offers
from autograder.judging.rows import publishers_at, seconds_after_join
from autograder.recording import Event, SECOND
from autograder.submission.code.source_code import Code

NODE = '/courier'
TOPIC = '/parcels'
TYPE = 'std_msgs/msg/String'
TEXT = 'for you'
AFTER_S = 4.0  # enough for a node that polls with a timer [s]
QUIET_S = 6.0  # without an expected parcel; long enough to notice a repeated one [s]
ALONE_S = 2.0  # enough for a node to notice that all subscriptions have left [s]
LATEST_S = 2.05  # a node that checks every two seconds is still on time [s]
SOON_S = 0.6  # from the second subscription to the parcel, if the node waited for it [s]
EXERCISE = 'Exercise 2: the courier who waits'
GONE = 'a node that has ended'

WHY = Causes(__file__, TOPIC=TOPIC)


def parcels(run: Run, listener: str) -> list[Event]:
    """Return the messages that one of the grader's subscriptions received, in order."""
    return run.recording.messages(TOPIC, listener)


def _lives(run: Run, when: str) -> bool:
    """Return whether the node's publisher is in the graph labelled ``delivered`` or ``end``."""
    return bool(publishers_at(run, when, TOPIC))


def _why_gone(run: Run) -> Cause | None:
    recording = run.recording
    if recording.process.get('exit') or recording.end_reason not in ('complete', 'student_exited'):
        return why_silent(run)
    if recording.process.get('exit') is None:
        return why_thread_ended(run) or WHY['destroyed']
    return WHY['exited_early']


def delivers_to_who_comes_late(run: Run) -> None:
    """It waits: a late subscription receives the parcel at once."""
    found = run.recording.phase('first').messages(TOPIC, 'first')
    # A message from a program that ends at once arrives only in some runs.
    lives = _lives(run, 'delivered')
    if not (found and lives):
        raise Failed(
            expected='one message for a subscription that joins after some seconds',
            observed='a subscription that receives nothing' if lives else GONE,
            why=_why_nothing_first(run, lives),
        )
    late_s = seconds_after_join(run, TOPIC, 'first')
    if late_s > LATEST_S:  # longer than the period of any usual timer
        when = 'seconds' if run.secret else f'{late_s:.2g} s'
        raise WHY.failed('delivers_late', when=when, about=[str(late_s)])


def _why_nothing_first(run: Run, lives: bool) -> Cause | None:
    """Explain why the first subscription receives nothing at first, or why the node ended."""
    if run.recording.of('joined', listener='first') and not lives:
        return _why_gone(run)
    if found := parcels(run, 'first'):
        second = run.recording.of('joined', listener='second')
        waited_ns = found[0]['clock_ns'] - second[0]['clock_ns'] if second else -1
        return WHY['waits_for_two'] if 0 <= waited_ns <= SOON_S * SECOND else WHY['delivers_late']
    if why := why_silent(run):
        return why
    code = Code(run.files)
    if 'publish' not in code.calls:
        return why_no_message(run)
    if not {'get_subscription_count', 'PublisherEventCallbacks'} & code.names:
        return WHY['too_early']
    again = {'create_timer', 'PublisherEventCallbacks'} & code.names or code.has_loop
    return WHY['looks_wrong'] if again else WHY['checks_once']


def addresses_the_parcel(run: Run) -> None:
    """The text of the parcel is: for you."""
    require_field(run, parcels(run, 'first')[:1], 'data', TEXT)


def delivers_once(run: Run) -> None:
    """It delivers exactly once: no later subscription gets a second message."""
    ends = run.recording.endpoints('publisher', TOPIC)
    if any(end['qos']['durability'] != 'VOLATILE' for end in ends):
        raise WHY.failed('qos_durability')
    early = sum(one['number'] - 1 for one in parcels(run, 'first')[:1])
    if early:
        raise WHY.failed('also_early', parcels=counted(early, 'parcel'))
    counts = [len(parcels(run, listener)) for listener in ('first', 'second', 'third')]
    first, second, third = counts
    lives = run.recording.end_reason == 'complete' and _lives(run, 'end')
    if counts == [1, 0, 0] and lives:
        return
    expected = '1 message for the first subscription, none for later ones'
    observed = f'messages for the first subscription: {first}, for the second: {second or "none"}'
    if third and not second:
        expected = 'no message for a subscription that connects after the others have left'
        observed = f'messages for the third subscription: {third}'
    elif counts == [1, 0, 0]:
        expected, observed = 'a node that keeps running after the delivery', GONE
    why = (why_silent(run) or _why_again(run, counts)) if lives else _why_gone(run)
    raise Failed(expected=expected, observed=observed, why=why)


def delivers_to_two_at_once(run: Run) -> None:
    """If two subscriptions connect in the same moment, it delivers exactly once, too."""
    found = parcels(run, 'crowd')
    if not found:
        raise WHY.failed('only_for_one', why_silent(run))
    if any(one['number'] > 1 for one in found):
        raise WHY.failed('one_for_each')


def _why_again(run: Run, counts: Sequence[int]) -> Cause:
    """Explain further parcels, given how many each of the three subscriptions received."""
    first, *later = counts
    if not any(later) and len({one['clock_ns'] for one in parcels(run, 'first')}) == 1:
        return WHY['several_at_once']
    # The matched callback does not run again while only the first subscription is connected.
    again = first > 2 or (first > 1 and not later[0])
    return WHY.of('delivers_again', closer=[WHY['forgets_delivery']] if again else ())


def build(
    alone_s: float, between_s: float = 1.0, others: int = 0, after_s: float = AFTER_S
) -> Exam:
    """
    Return the exam: three subscriptions join in turn, the third after the first two have left.

    :param alone_s: time before the first subscription joins [s]
    :param between_s: additional time between the delivery and the second subscription [s]
    :param others: number of further subscriptions, which join in turn after the third
    :param after_s: time after the last subscription [s]
    """
    steps: tuple[Step, ...] = (
        Advance(alone_s),
        # A subscription of a different type exists, but cannot connect.
        *(Join('stranger', TOPIC, 'std_msgs/msg/Int32'), Leave('stranger')),
        *(Mark('first'), Join('first', TOPIC, TYPE), Advance(AFTER_S), Look('delivered')),
        *(Advance(between_s), Mark('second'), Join('second', TOPIC, TYPE), Advance(QUIET_S)),
        *(Mark('third'), Leave('first'), Leave('second'), Advance(ALONE_S)),
        Join('third', TOPIC, TYPE),
        *(Join(f'other_{number}', TOPIC, TYPE) for number in range(others)),
        Advance(after_s),
    )
    crowd = (Advance(ALONE_S), Join('crowd', TOPIC, TYPE, copies=2), Advance(AFTER_S))
    again = Scenario(file='courier.py', steps=crowd)
    exam = Exam(
        'courier',
        title='The courier',
        assignment='03_topics',
        part=2,
        scenario=Scenario(file='courier.py', steps=steps, again=again),
        read='Part 3: Discovery takes time',
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=1, read='Part 1: Speaking and listening')(
        offers(TOPIC, TYPE, 'offers_parcels', 'It has a publisher of String messages on parcels.')
    )
    exam.check(points=4, needs=['offers_parcels'])(delivers_to_who_comes_late)
    needs = ['delivers_to_who_comes_late']
    exam.check(points=1, needs=needs, read=EXERCISE)(addresses_the_parcel)
    exam.check(points=2, needs=needs)(delivers_once)
    exam.check(points=1, needs=['delivers_once'], again=True)(delivers_to_two_at_once)
    return exam


exam = build(alone_s=4.0)
