"""
Lesson 05, part 4: the map server.

The specification, as the lesson gives it: node ``map_server``; a ``std_msgs/msg/String`` on
``map``: ``unknown`` once at the start, then each text that arrives on ``survey``, once and
unchanged; who comes late gets the newest map and no older one.  A graph does not tell a depth, so
two listeners of ours join, one at the start and one after the surveys: both ask for a history.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Feed, FeedTopic, Join, Qos, Scenario
from autograder.exam.slips import leaving_out, MISSES_SOME
from autograder.exam.specification import each, in_order, Rule, Slip, Specification
from autograder.judging.causes.ended import why_no_endpoint, why_silent
from autograder.judging.causes.redaction import own_words
from autograder.judging.checks import SECOND
from autograder.judging.claims import node, offers
from autograder.judging.rows import Row, rows
from autograder.recording import Event
from autograder.submission.code.learners_code import Code

TYPE = 'std_msgs/msg/String'
FIRST = 'unknown'
HISTORY = Qos(durability='TRANSIENT_LOCAL', depth=50)
LISTEN_S = 2.0  # for each listener, in which a timer would publish again
FIRST_S = 0.2  # the first map is there before anybody comes, and arrives at once [s]
REST_S = 5.0  # after the last survey, likewise
LATCH = Cause(
    'not_latched',
    'The publisher keeps nothing for those who come later.',
    'Give its profile durability=DurabilityPolicy.TRANSIENT_LOCAL.',
)
BEST_EFFORT = Cause(
    'best_effort',
    'The publisher offers best effort, so nobody who needs every map is connected to it.',
    'Give its profile reliability=ReliabilityPolicy.RELIABLE.',
)
ASKS_TOO_MUCH = Cause(
    'asks_too_much',
    'No message reaches your subscription on survey: its profile requests more than an ordinary '
    'publisher offers.',
    "Subscribe with the plain number: create_subscription(String, 'survey', self.take, 10).",
)
PUBLISHER_GONE = Cause(
    'publisher_gone',
    'Your program destroys a publisher, and what it keeps for late subscriptions goes with it.',
    'Create one publisher in __init__, and publish every map with it.',
)
REPEATS = Cause('repeats', 'Maps are published more than once.', 'Publish once per survey.')
TEXT_CHANGED = Cause(
    'text_changed',
    'A text comes with other letters or spaces than its survey, and both count.',
    'Publish String(data=survey.data) as it is, without strip(), lower() or upper().',
)
Maps = tuple[str, ...]
"""What is published after one survey."""


def passed_on(change: Callable[[str], str] = lambda text: text, times: int = 1) -> Rule:
    """Return the rule of a server that publishes each survey, by default once and unchanged."""
    return each(lambda text: (change(text),) * times)


SLIPS = (
    *leaving_out(passed_on()),
    Slip.of(REPEATS, passed_on(times=2)),
    Slip(
        'one_behind',
        'Each survey is published only when the next one comes.',
        'Publish the survey that has come: String(data=survey.data).',
        lambda texts: [(), *((text,) for text in texts[:-1])],
    ),
    Slip(
        'text_cut',
        'A long text is cut off.',
        'Publish String(data=survey.data) as it is, however long.',
        passed_on(lambda text: text[:100]),
    ),
    *(
        Slip.of(TEXT_CHANGED, passed_on(change))
        for change in (str.strip, str.lower, str.upper, str.title)
    ),
)
AGAIN = 'again and again'
FIRST_AGAIN = Cause(
    'repeats',
    'The first map is published again after the surveys, so it is the newest one.',
    'Publish it once, at the end of __init__, and not in a timer.',
)
EXERCISE = 'Exercise 1: a map server'


def maps_of(run: Run, listener: str | None = None) -> list[str]:
    """Return the maps that one listener heard, in order; None is content with any offer."""
    return [
        str(event['data']['data'])
        for event in run.recording.messages('/map', listener)
        if 'data' in event
    ]


def new_maps(run: Run) -> list[Maps | None]:
    """
    Return the maps that came after each survey, without the first one.

    A publisher that was made a moment ago is not yet connected to our volatile listener, and the
    early one, for which it keeps its map, hears it all the same.
    """
    heard = [rows(run, 'maps', run.recording.messages('/map', one)) for one in (None, 'early')]
    return [row if row is None else _texts(row) for row in max(heard, key=_how_many)]


def compared(run: Run) -> list[Maps | None]:
    """Return the same in the order of a specification: threads may answer a burst in any order."""
    *singles, last = new_maps(run)
    return [*singles, in_order(last) if last and asked(run).burst else last]


def _how_many(found: Sequence[Row | None]) -> int:
    return sum(len(_texts(row or ())) for row in found)


def _texts(row: Sequence[Event]) -> Maps:
    texts = (str(event['data']['data']) for event in row if 'data' in event)
    return tuple(text for text in texts if text != FIRST)


def asked(run: Run) -> Specification:
    """Return what is due after each survey."""
    found: Specification = run.facts['maps']
    return found


def publishers_of_maps(run: Run) -> int:
    """Return how many publishers on map there were at a time."""
    counts = [
        sum((end['kind'], end['topic']) == ('publisher', '/map') for end in graph['endpoints'])
        for graph in run.recording.of('graph')
    ]
    return max(counts, default=0)


def has_a_map_from_the_start(run: Run) -> None:
    """Who comes before the first survey gets the map unknown, once and at once."""
    found = maps_of(run, 'early')
    if found[:1] != [FIRST] or found.count(FIRST) != 1:
        raise Failed(
            expected=f'one map, {FIRST!r}, before any survey',
            observed=_shown(run, [text for text in found if text not in asked(run).inputs]),
            why=_why_no_first_map(run, found),
        )
    joined = run.recording.of('joined', listener='early')[0]
    late_s = (run.recording.messages('/map', 'early')[0]['clock_ns'] - joined['clock_ns']) / SECOND
    if late_s > FIRST_S:
        raise Failed(
            expected=f'the map {FIRST!r} as soon as the node exists',
            observed=f'it comes {late_s:.2g} s after a listener',
            why=Cause(
                'first_map_late',
                'The first map is published some time after the start.',
                'Publish it at the end of __init__, and not in a timer.',
            ),
        )


def _why_no_first_map(run: Run, found: Sequence[str]) -> Cause | None:
    if why := why_silent(run) or _why_unmatched(run, 'early'):
        return why
    if found.count(FIRST) > 1:
        return Cause(
            'repeats',
            'The first map is published again and again.',
            'Publish it once, at the end of __init__; transient local does the rest.',
        )
    if FIRST not in found and 'destroy_publisher' in Code(run.files).calls:
        return PUBLISHER_GONE
    before = [text for text in found if text not in asked(run).inputs]
    if before and before[0].strip().lower() == FIRST:
        return Cause('wrong_text', 'Upper and lower case and spaces count.', f'Write {FIRST!r}.')
    if before:
        return Cause('wrong_text', 'The first map has another text.', f'Write {FIRST!r}.')
    return Cause(
        'no_first_map',
        'No map was published before the first survey.',
        f'Publish String(data={FIRST!r}) at the end of __init__.',
    )


def _why_unmatched(run: Run, listener: str) -> Cause | None:
    """Explain why a listener that asks for all that a latched map offers is not connected."""
    joined = run.recording.of('joined', listener=listener)
    if not joined or joined[0]['matched']:
        return None
    ends = run.recording.endpoints('publisher', '/map')
    if not any(end['type'] == TYPE for end in ends):
        return why_no_endpoint(run, 'publisher', '/map', TYPE)
    if any(end['qos']['reliability'] != 'RELIABLE' for end in ends):
        return BEST_EFFORT
    return LATCH if 'DURABILITY' in joined[0]['refused'] else None


def publishes_each_survey(run: Run) -> None:
    """Each survey becomes the new map, unchanged and once."""
    surveys, found = asked(run).inputs, compared(run)
    if None in found or asked(run).wrong(found):
        raise Failed(
            expected='a map for each survey, in their order'
            if run.secret
            else f'the maps {_shown(run, surveys)} after the surveys of the same texts',
            observed=_shown(run, _in_order(run)),
            why=_why_other_maps(run),
        )


def _in_order(run: Run) -> list[str]:
    """Return all new maps, one after the other."""
    return [text for row in new_maps(run) for text in row or ()]


def _why_other_maps(run: Run) -> Cause | None:
    if why := why_silent(run):
        return why
    if run.recording.of('not_connected'):
        return _why_unreached(run)
    found = compared(run)
    if not any(found) and not run.recording.endpoints('publisher', '/map'):
        return why_no_endpoint(run, 'publisher', '/map', TYPE)
    surveys = asked(run).inputs
    if slip := next((asked(run).cause(found, place) for place in asked(run).wrong(found)), None):
        return slip
    others = [text for text in _in_order(run) if text not in surveys]
    if others and _bare(others[0]) in map(_bare, surveys):
        return TEXT_CHANGED
    if others:
        text = f'{own_words(run, others[0][:40], "What is published")} is no text of a survey.'
        return Cause('wrong_text', text, 'Publish String(data=survey.data), unchanged.')
    if any(len(row or ()) > len(asked(run).row(place)) for place, row in enumerate(found)):
        return REPEATS
    return MISSES_SOME if len(found[-1] or ()) < asked(run).burst else None


def _bare(text: str) -> str:
    """Return a text without spaces, in lower case."""
    return ''.join(text.split()).lower()


def _why_unreached(run: Run) -> Cause:
    ends = run.recording.endpoints('subscription', '/survey')
    if any(end['type'] == TYPE for end in ends):
        return ASKS_TOO_MUCH
    return why_no_endpoint(run, 'subscription', '/survey', TYPE)


def keeps_only_the_newest(run: Run) -> None:
    """Who comes after the surveys gets the newest map at once, and no older one."""
    ends = run.recording.endpoints('publisher', '/map')
    expiring = [end['qos']['lifespan_ns'] for end in ends if end['qos']['lifespan_ns']]
    if expiring:
        raise Failed(
            expected='a newest map for who comes late, however late',
            observed=f'maps that expire after {expiring[0] / SECOND:g} s',
            why=Cause(
                'lifespan',
                'The profile has a lifespan: later than that, nothing is kept for anybody.',
                'Leave lifespan out.',
            ),
        )
    # Of its own maps: what they say is another check's business.
    newest = [*asked(run).inputs, *_in_order(run)][-1]
    # What several publishers keep arrives in any order.
    order = {text: place for place, text in enumerate((FIRST, *asked(run).inputs))}
    found = sorted(maps_of(run, 'late'), key=lambda text: (order.get(text, len(order)), text))
    if set(found) != {newest}:
        raise Failed(
            expected=f'the newest map, {_named(run, newest)}, and nothing else, '
            'for who comes late',
            observed=_shown(run, found),
            why=why_silent(run)
            or _why_unmatched(run, 'late')
            or _why_many(run, found)
            or (FIRST_AGAIN if set(found) == {FIRST} and _in_order(run) else None)
            or _why_other_maps(run),
        )


def _why_many(run: Run, found: Sequence[str]) -> Cause | None:
    """Explain more than one map for who comes late."""
    kept = len(set(found))
    if kept < 2:
        return None
    publishers = publishers_of_maps(run)
    if publishers > 1:
        return Cause(
            'several_publishers',
            f'There are {publishers} publishers on map, and each keeps a map of its own.',
            'Create one publisher in __init__, and publish with it in the callback.',
        )
    return Cause(
        'keeps_too_many',
        f'The publisher keeps {kept} maps or more for those who come late.',
        'Give its profile depth=1: keep the last one.',
    )


def _named(run: Run, text: str) -> str:
    """Name a map: by its text, or where the surveys are secret by the number of its survey."""
    surveys = asked(run).inputs
    if run.secret and text in surveys:
        return f'survey {list(dict.fromkeys(surveys)).index(text) + 1}'
    return repr(text) if text == FIRST else own_words(run, text[:40], 'another text')


def _shown(run: Run, texts: Sequence[str]) -> str:
    surveys = asked(run).inputs
    shown = []
    for text, same in groupby(texts):
        count = len(list(same))
        # Which survey comes twice is secret.
        many = count > 2 or text not in surveys or len(texts) > len(surveys)
        often = AGAIN if many else '' if run.secret else 'twice'
        shown.append(f'{_named(run, text)} {often if count > 1 else ""}'.rstrip())
    return ', '.join(shown[:6]) or 'no map'


def build(surveys: Sequence[str], burst: int = 0) -> Exam:
    """
    Return the exam with some surveys.

    :param surveys: at least three different texts; one has outer spaces and a capital letter, and
        one comes twice in a row
    :param burst: how many of them come at once at the end, at most five
    """
    messages = [{'data': text} for text in surveys]
    singles = len(surveys) - burst
    feeds = [Feed('/survey', messages[:singles], optional=True, rest_s=0.0 if burst else REST_S)]
    if burst:
        feeds.append(Feed('/survey', messages[singles:], burst=True, optional=True, rest_s=REST_S))
    exam = Exam(
        'map_server',
        title='The map server',
        assignment='05_quality_of_service',
        part=1,
        scenario=Scenario(
            file='map_server.py',
            watch={'/map': TYPE},
            feed={'/survey': FeedTopic(TYPE, Qos())},
            steps=(
                Join('early', '/map', TYPE, HISTORY, LISTEN_S),
                *feeds,
                Join('late', '/map', TYPE, HISTORY, LISTEN_S),
            ),
        ),
        read='Part 4: Those who come late',
        asks={'maps': Specification(surveys, passed_on(), SLIPS, burst)},
    )
    exam.check(points=1, read=EXERCISE)(node('/map_server', only_named=True))
    exam.check(points=2)(
        offers(
            '/map',
            TYPE,
            'offers_a_latched_map',
            'It publishes String messages on map, reliable and transient local.',
            reliability='RELIABLE',
            durability='TRANSIENT_LOCAL',
        )
    )
    for points, judge, read in (
        (2, has_a_map_from_the_start, ''),
        (2, publishes_each_survey, EXERCISE),
        (3, keeps_only_the_newest, ''),
    ):
        exam.check(points=points, needs=['starts_its_node'], read=read)(judge)
    return exam


exam = build(
    ['hall', ' hall and Cellar  ', 'hall, cellar and yard', 'hall, cellar and yard', 'all of it']
)
