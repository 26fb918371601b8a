"""
Lesson 05, part 4: the map server.

The specification, as the lesson gives it: node ``map_server``; a ``std_msgs/msg/String`` on
``map``: ``unknown`` once at the start, then each text that arrives on ``survey``, once and
unchanged; who comes late gets the newest map and no older one.  A graph does not tell a depth, so
two listeners of ours join, one at the start and one after the surveys: both ask for a history.
"""

from __future__ import annotations

from collections.abc import Sequence

from autograder.causes import why_no_endpoint, why_silent
from autograder.checks import require_endpoint, require_node, require_qos
from autograder.exam import Cause, Exam, Failed, Run
from autograder.scenario import Feed, FeedTopic, Join, Qos, Scenario

TYPE = 'std_msgs/msg/String'
FIRST = 'unknown'
HISTORY = Qos(durability='TRANSIENT_LOCAL', depth=50)
LATCH = Cause(
    'not_latched',
    'The publisher keeps nothing for those who come later.',
    'Give its profile durability=DurabilityPolicy.TRANSIENT_LOCAL.',
)
ASKS_TOO_MUCH = Cause(
    'asks_too_much',
    'Nobody can reach your subscription on survey: its profile requests more than an ordinary '
    'publisher offers.',
    "Subscribe with the plain number: create_subscription(String, 'survey', self.take, 10).",
)


def maps_of(run: Run, listener: str | None = None) -> list[str]:
    """Return the maps that one listener heard, in order; None is content with any offer."""
    return [
        str(event['data']['data'])
        for event in run.recording.messages('/map', listener)
        if 'data' in event
    ]


def starts_its_node(run: Run) -> None:
    """Your program starts a node called map_server."""
    require_node(run, '/map_server')


def offers_a_latched_map(run: Run) -> None:
    """It publishes String messages on map, reliable and transient local."""
    ends = require_endpoint(run, 'publisher', '/map', TYPE)
    require_qos(ends, reliability='RELIABLE', durability='TRANSIENT_LOCAL')


def has_a_map_from_the_start(run: Run) -> None:
    """Who comes before the first survey gets the map unknown, once."""
    found = maps_of(run, 'early')
    if found[:1] == [FIRST] and found.count(FIRST) == 1:
        return
    raise Failed(
        expected=f'one map, {FIRST!r}, before any survey',
        observed=_shown([text for text in found if text not in run.facts['surveys']]),
        why=_why_no_first_map(run, found),
    )


def _why_no_first_map(run: Run, found: Sequence[str]) -> Cause | None:
    if why := why_silent(run):
        return why
    if found.count(FIRST) > 1:
        return Cause(
            'repeats',
            'The first map is published again and again.',
            'Publish it once, at the end of __init__; transient local does the rest.',
        )
    joined = run.recording.of('joined', listener='early')
    if joined and not joined[0]['matched']:
        return LATCH
    if found and found[0].strip().lower() == FIRST:
        return Cause('wrong_text', 'Upper and lower case and spaces count.', f'Write {FIRST!r}.')
    return Cause(
        'no_first_map',
        'No map was published before the first survey.',
        f'Publish String(data={FIRST!r}) at the end of __init__.',
    )


def publishes_each_survey(run: Run) -> None:
    """Each survey becomes the new map, unchanged and once."""
    surveys = run.facts['surveys']
    found = [text for text in maps_of(run) if text != FIRST]
    if found == list(surveys):
        return
    why = why_silent(run)
    if not why and run.recording.of('not_connected'):
        why = _why_unreached(run)
    if not why and len(found) > len(surveys):
        why = Cause('repeats', 'Maps are published more than once.', 'Publish once per survey.')
    if not why and len(found) == len(surveys):
        slip = 'The texts are not those of the surveys.'
        why = Cause('wrong_text', slip, 'Publish String(data=survey.data), unchanged.')
    raise Failed(
        expected=f'the maps {_shown(surveys)} after the surveys of the same texts',
        observed=_shown(found),
        why=why,
    )


def _why_unreached(run: Run) -> Cause:
    if run.recording.endpoints('subscription', '/survey'):
        return ASKS_TOO_MUCH
    return why_no_endpoint(run, 'subscription', '/survey', TYPE)


def keeps_only_the_newest(run: Run) -> None:
    """Who comes after the surveys gets the newest map at once, and no older one."""
    # Of its own maps: what they say is another check's business.
    unreached = bool(run.recording.of('not_connected'))
    newest = [*run.facts['surveys'], *([] if unreached else maps_of(run))][-1]
    found = maps_of(run, 'late')
    if found == [newest]:
        return
    why = why_silent(run) or (_why_unreached(run) if unreached else None)
    joined = run.recording.of('joined', listener='late')
    if not why and joined and 'DURABILITY' in joined[0]['refused']:
        why = LATCH
    elif not why and len(found) > 1:
        why = Cause(
            'keeps_too_many',
            f'The publisher keeps {len(found)} maps or more for those who come late.',
            'Give its profile depth=1: keep the last one.',
        )
    raise Failed(
        expected=f'the newest map, {newest!r}, and nothing else, for who comes late',
        observed=_shown(found),
        why=why,
    )


def _shown(texts: Sequence[str]) -> str:
    return ', '.join(repr(text[:40]) for text in texts[:6]) or 'no map'


def build(surveys: Sequence[str]) -> Exam:
    """
    Return the exam with some surveys.

    :param surveys: at least three different texts
    """
    exam = Exam(
        'map_server',
        title='The map server',
        assignment='05_quality_of_service',
        part=1,
        cells=('map_server',),
        requires=('map_server.py',),
        scenario=Scenario(
            file='map_server.py',
            watch={'/map': TYPE},
            feed={'/survey': FeedTopic(TYPE, Qos())},
            steps=(
                Join('early', '/map', TYPE, HISTORY),
                Feed('/survey', [{'data': text} for text in surveys], optional=True),
                Join('late', '/map', TYPE, HISTORY),
            ),
            first_log_s=0,
        ),
        read='Part 4: Those who come late',
        facts={'surveys': list(surveys)},
    )
    exam.check(points=1)(starts_its_node)
    exam.check(points=2)(offers_a_latched_map)
    for points, judge in (
        (2, has_a_map_from_the_start),
        (2, publishes_each_survey),
        (3, keeps_only_the_newest),
    ):
        exam.check(points=points, needs=['starts_its_node'])(judge)
    return exam


exam = build(['hall', 'hall and cellar', 'hall, cellar and yard'])
