"""
Lesson 02, part 5: a slow callback and a heartbeat that does not wait for it.

Specification from the lesson: node ``inspector``; it answers each ``std_msgs/msg/String`` on
``pictures`` with one on ``results``, which contains the result of the slow function ``inspect()``;
``inspect()`` takes 1.2 s and never runs twice at the same time; a ``std_msgs/msg/Empty`` on
``alive`` every 0.5 s, even during an inspection.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, pairwise

from autograder.exam.exam import Cause, Exam, Run, Scenario
from autograder.exam.slips import leaving_out
from autograder.exam.specification import each, Specification
from autograder.exam.steps import Advance, Feed, feeds
from autograder.exam.words import Causes
from autograder.judging.checks import require_messages
from autograder.judging.claims import node, one_for_one, passes, publishes
from autograder.judging.rhythm import GRAIN_S, require_period, seconds_between
from autograder.recording import SECOND
from autograder.submission.code.source_code import Code

SOURCE, TARGET, ALIVE = '/pictures', '/results', '/alive'
STRING, EMPTY = 'std_msgs/msg/String', 'std_msgs/msg/Empty'
BEAT_S, INSPECT_S = 0.5, 1.2
LEAST_S = INSPECT_S - GRAIN_S
EVERY_S = 2.5  # between two pictures: enough for a thread that polls for them [s]
REST_S = 2.0  # after the last single picture, and again after the burst [s]
QUIET_S = 3.2  # at the start, without a picture [s]
FIRST = 2  # pictures before the pause
PAUSE_S = 14.0  # longer than an idle thread usually waits [s]
EXERCISE = 'Exercise 1: a heartbeat that never waits'
looked_at = each(lambda picture: (picture.upper(),))
WHY = Causes(__file__, INSPECT_S=INSPECT_S)


def _ends_in_the_pause(pictures: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the results of a node whose thread ends when no picture comes for some time."""
    return [*looked_at(pictures[:FIRST]), *[()] * len(pictures[FIRST:])]


def _skips_waiting(pictures: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the results of a node that keeps equal pictures only once while they wait."""
    # Only in the burst, where pictures wait, does one equal the last but one.
    again = (False, False, *map(str.__eq__, pictures[2:], pictures))
    return [() if one else due for one, due in zip(again, looked_at(pictures))]


SLIPS = (
    WHY.slip('passes_on', each(lambda picture: (picture,))),
    WHY.slip('empty_result', each(lambda picture: ('',))),
    WHY.slip('grows', lambda pictures: [(one,) for one in accumulate(map(str.upper, pictures))]),
    WHY.slip('strips', each(lambda picture: (picture.strip().upper(),))),
    *leaving_out(looked_at),
    WHY.slip('ends_in_the_pause', _ends_in_the_pause),
    WHY.slip('skips_waiting', _skips_waiting),
)


def _moments(run: Run, topic: str) -> list[float]:
    return [one['clock_ns'] / SECOND for one in run.recording.messages(topic)]


def why_starved(run: Run) -> Cause | None:
    """Explain heartbeats that are regular at first, but stop during inspections."""
    beats, results = _moments(run, ALIVE), _moments(run, TARGET)
    if sum(beat < QUIET_S for beat in beats) < 2 or not results:
        return None
    during = [beat for beat in beats for end in results if GRAIN_S < end - beat < LEAST_S]
    if not during:
        calls = Code(run.files).calls
        groups = len(calls.get('MutuallyExclusiveCallbackGroup', ())) > 1
        apart = 'MultiThreadedExecutor' in calls and (groups or 'ReentrantCallbackGroup' in calls)
        locks = calls.keys() & {'Lock', 'RLock', 'Semaphore'}
        if 'MultiThreadedExecutor' not in calls:
            return replace(WHY['starved'], act='spin()')
        closer = [WHY['beats_left_out']] * apart
        return WHY['waits_for_lock'] if apart and locks else replace(WHY['starved'], closer=closer)
    last_s = max((one['clock_ns'] for one in run.recording.of('input')), default=0) / SECOND
    late = [end for begun, end in pairwise(beats) if end - begun > BEAT_S + GRAIN_S]
    starved = late and all(last_s < one < results[-1] + BEAT_S for one in late)
    several = 'MultiThreadedExecutor' in Code(run.files).calls
    return WHY['threads_used_up'] if starved and several else None


def keeps_its_rhythm(run: Run) -> None:
    """It publishes a heartbeat every 0.5 s, even while it inspects a picture."""
    found, seconds = require_messages(run, topic=ALIVE), run.facts['seconds']
    waited_s = seconds_between(run.recording.of('seen'), found)
    require_period(
        run, found, BEAT_S, seconds, 'heartbeat', lambda: why_starved(run), waited_s=waited_s
    )


def inspects_one_at_a_time(run: Run) -> None:
    """One inspection per picture takes 1.2 s, and the next one begins after it has ended."""
    sent = [one['clock_ns'] / SECOND for one in run.recording.of('input')]
    ends = [
        one['clock_ns'] / SECOND
        for one in run.recording.messages(TARGET)
        if one['after_input'] is not None  # a different check reports these
    ]
    short = [n for n, (begun, end) in enumerate(zip(sent, ends)) if end - begun < LEAST_S]
    if short:
        pictures = run.asked('pictures').inputs
        known = all(pictures[place] in pictures[:place] for place in short)
        raise WHY.failed('remembers' if known else 'not_inspected')
    # A thread that polls may begin late with the first picture, but not between those of a burst.
    alone = [*zip(sent[:1], ends), *pairwise(ends[-2:])]
    takes_s = min((end - begun for begun, end in alone), default=0.0)
    if takes_s > 2 * INSPECT_S - GRAIN_S:
        raise WHY.failed('inspects_twice', takes_s=takes_s)
    if any(later - earlier < LEAST_S for earlier, later in pairwise(ends)):
        raise WHY.failed('overlaps')


def build(pictures: Sequence[str], burst: int) -> Exam:
    """
    Return the exam for some pictures.

    :param pictures: texts; one is sent twice in a row, one again later, one is empty, and
        one has spaces around it
    :param burst: number of pictures at the end that are sent at once
    """
    sent = [{'data': picture} for picture in pictures]
    rest_s = QUIET_S + PAUSE_S + 2 * REST_S
    steps = (
        Advance(QUIET_S),
        Feed(SOURCE, sent[:FIRST], every_s=EVERY_S, rest_s=PAUSE_S),
        *feeds(SOURCE, sent[FIRST:], burst, every_s=EVERY_S, rest_s=REST_S),
    )
    exam = Exam(
        'inspector',
        title='A heartbeat that never waits',
        assignment='02_spinning',
        part=1,
        scenario=Scenario(
            file='inspector.py',
            watch={TARGET: STRING, ALIVE: EMPTY},
            feed={SOURCE: STRING},
            steps=steps,
        ),
        read='Part 3: Callbacks and threads',
        facts={'seconds': rest_s + EVERY_S * len(sent), 'slow_callback': True},
        asks={'pictures': Specification(tuple(pictures), looked_at, SLIPS, burst)},
    )
    exam.check(points=1, read=EXERCISE)(node('/inspector'))
    exam.check(points=1, read=EXERCISE)(passes((SOURCE, STRING), (TARGET, STRING)))
    exam.check(points=1, needs=['reads_and_writes'], read=EXERCISE)(
        one_for_one('pictures', TARGET, sentence='Each picture has exactly one result.')
    )
    exam.check(points=1, needs=['one_for_one'], read=EXERCISE)(
        publishes('pictures', TARGET, sentence='Each result is the string that inspect() returns.')
    )
    exam.check(points=3, needs=['one_for_one'])(inspects_one_at_a_time)
    exam.check(points=3, needs=['reads_and_writes'])(keeps_its_rhythm)
    return exam


exam = build(['cat', 'dog', 'dog', '', 'cat', ' owl ', 'fox', 'bee', 'ant'], burst=3)
