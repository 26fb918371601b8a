"""
Lesson 05, part 4: the map server.

Specification from the lesson: node ``map_server``; it publishes ``std_msgs/msg/String`` on
``map``: ``unknown`` once at the start, then each text that arrives on ``survey``, once and
unchanged; late subscriptions receive the newest map and no older one.

The graph does not contain the depth of a publisher.  So three subscriptions of the probe join and
request a history: at the start, after the surveys, and after one more survey, which arrives while
nothing subscribes to the map.
"""

from collections.abc import Callable, Sequence
from itertools import groupby
from operator import itemgetter

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import FeedTopic, Scenario
from autograder.exam.slips import leaving_out
from autograder.exam.specification import each, Rule, sorted_answers, Specification
from autograder.exam.steps import Advance, Feed, feeds, Join, Leave, Offer, Qos
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_no_endpoint, why_silent
from autograder.judging.causes.redaction import safe_quotation
from autograder.judging.checks import why_not_reached
from autograder.judging.claims import node, offers
from autograder.judging.rhythm import seconds_between
from autograder.judging.rows import delays, publishers_at, rows, why_other_answer
from autograder.recording import Event, SECOND

TYPE = 'std_msgs/msg/String'
FIRST = 'unknown'
HISTORY = Qos(durability='TRANSIENT_LOCAL', depth=50)
LISTEN_S = 2.0  # per subscription: enough to notice a timer that publishes again [s]
FIRST_S = 0.08  # minimum from the first map until the node is seen; discovery takes 0.11 s [s]
REST_S = 5.0  # before and after a burst: enough to notice a timer that publishes again [s]
ALONE_S = 31.0  # without a publisher of surveys: enough to notice a map repeated every 30 s [s]
EXERCISE = 'Exercise 1: a map server'
Maps = tuple[str, ...]
"""The maps published after one survey."""
WHY = Causes(__file__, FIRST=FIRST)


def passed_on(change: Callable[[str], str] = str, times: int = 1) -> Rule:
    """Return the rule of a server that publishes each survey, by default once and unchanged."""
    return each(lambda text: (change(text),) * times)


def joined(between: str) -> Rule:
    """Return the rule of a server that publishes all surveys so far, in one text."""
    return lambda texts: [(between.join(texts[:count]),) for count in range(1, len(texts) + 1)]


CUTS = (50, 64, 80, 100, 128, 200, 255, 256, 500, 512, 1000, 1023, 1024, 2000, 2048)
ONE_BEHIND = WHY.slip('one_behind', lambda texts: [(), *((text,) for text in texts[:-1])])
SLIPS = (
    *leaving_out(passed_on()),
    WHY.slip('repeats', passed_on(times=2)),
    WHY.slip('joins', *(joined(between) for between in ('', ' ', ', ', '\n', ' and ', '; '))),
    ONE_BEHIND,
    WHY.slip('text_cut', *(passed_on(itemgetter(slice(to))) for to in CUTS)),
    WHY.slip(
        'text_changed', *(passed_on(one) for one in (str.strip, str.lower, str.upper, str.title))
    ),
)


def texts_of(events: Sequence[Event]) -> Maps:
    """Return the texts of recorded messages, in order."""
    return tuple(str(event['data']['data']) for event in events if 'data' in event)


def new_maps(run: Run) -> list[Maps | None]:
    """
    Return the maps received after each survey, without the first map.

    A publisher that the node has just created is not yet connected to the probe's volatile
    subscription.  The early, transient local subscription still receives the map that such a
    publisher stores.  So this function uses the subscription that received more maps.
    """
    heard = [
        [
            row if row is None else tuple(text for text in texts_of(row) if text != FIRST)
            for row in rows(run, 'maps', run.recording.messages('/map', listener))
        ]
        for listener in (None, 'early')
    ]
    return max(heard, key=lambda found: sum(len(row or ()) for row in found))


def compared(run: Run) -> list[Maps | None]:
    """Return the new maps; those of a burst are sorted, as threads may publish in any order."""
    *singles, last = new_maps(run)
    return [*singles, sorted_answers(last) if last and run.asked('maps').burst else last]


def has_a_map_from_the_start(run: Run) -> None:
    """A subscription that joins before any survey gets the map 'unknown' once, immediately."""
    found = texts_of(run.recording.messages('/map', 'early'))
    before = [text for text in found if text not in run.asked('maps').inputs]
    if found[:1] != (FIRST,) or found.count(FIRST) != 1:
        raise Failed(
            expected=f'one map, {FIRST!r}, before any survey',
            observed=_shown(run, before),
            why=_why_no_first_map(run, found, before),
        )
    first = run.recording.messages('/map', 'early')[:1]
    seen_s = first[0].get('age_ns', 0) / SECOND - seconds_between(run.recording.of('seen'), first)
    if seen_s < FIRST_S:
        raise WHY.failed('first_map_late')


def _why_no_first_map(run: Run, found: Sequence[str], before: Sequence[str]) -> Cause | None:
    """Explain why the first map is missing or wrong, given texts that are not surveys."""
    if why := why_silent(run) or _why_unmatched(run, 'early'):
        return why
    if found.count(FIRST) > 1:
        if run.asked('maps').cause(compared(run)) is ONE_BEHIND:
            return ONE_BEHIND
        # Before any survey, only a timer repeats the map.
        act = 'publishing_timer' if found[:2] == (FIRST, FIRST) else ''
        return WHY['replaces_empty'] if _replaces_empty(run) else WHY.of('first_repeats', act=act)
    if not before:
        return WHY['no_first_map']
    if before[0] == FIRST:  # this map arrived after a survey
        return WHY['first_map_late']
    return WHY['first_text']


def _replaces_empty(run: Run) -> bool:
    """Return whether the text of the first map is published again only after empty surveys."""
    asked = run.asked('maps')
    again = [
        asked.inputs[one['after_input']]
        for one in run.recording.messages('/map', 'early')
        if one['after_input'] is not None and texts_of([one]) == (FIRST,)
    ]
    return bool(again) and not any(again)


def _why_unmatched(run: Run, listener: str) -> Cause | None:
    """Explain why a subscription that requests a latched map is not connected."""
    joined = run.recording.of('joined', listener=listener)
    if not joined or joined[0]['matched']:
        return None
    ends = run.recording.endpoints('publisher', '/map')
    if not any(end['type'] == TYPE for end in ends):
        return why_no_endpoint(run, 'publisher', '/map', TYPE)
    if any(end['qos']['reliability'] != 'RELIABLE' for end in ends):
        return WHY['best_effort']
    return WHY['not_latched'] if 'DURABILITY' in joined[0]['refused'] else None


def publishes_each_survey(run: Run) -> None:
    """Each survey becomes the new map, unchanged and once."""
    asked, found = run.asked('maps'), compared(run)
    if None in found or asked.wrong(found):
        raise Failed(
            expected='a map for each survey, in the same order'
            if run.secret
            else f'the maps {_shown(run, asked.inputs)} after surveys with the same texts',
            observed=_shown(run, _all_new(run)),
            why=_why_other_maps(run),
        )


def _all_new(run: Run) -> list[str]:
    return [text for row in new_maps(run) for text in row or ()]


def _why_other_maps(run: Run) -> Cause | None:
    asked, found = run.asked('maps'), compared(run)
    if why := why_silent(run) or _why_unconnected(run, any(found)):
        return why
    if _replaces_empty(run):
        return WHY['replaces_empty']
    if slip := asked.cause(found):
        return slip
    others = [text for text in _all_new(run) if text not in asked.inputs]
    bare = [''.join(text.split()).lower() for text in (*others[:1], *asked.inputs)]
    if others and bare[0] in bare[1:]:
        return WHY['text_changed']
    if others:
        said = safe_quotation(run, others[0][:40], 'A published map')
        return WHY.of('wrong_text', said=said)
    joined = [one['clock_ns'] for one in run.recording.of('joined', listener='late')]
    at_join = [one for one in run.recording.messages('/map') if one['clock_ns'] in joined]
    if at_join and asked.wrong(found) == [len(found) - 1]:
        return WHY['repeats_for_new']
    late_s, wrong = delays(run, 'maps', '/map'), asked.wrong(found)
    return why_other_answer(asked, found, wrong[0], late_s) if wrong else None


def _why_unconnected(run: Run, answered: bool) -> Cause | None:
    """Explain why no survey reaches the node, or why its maps have no publisher."""
    if run.recording.of('not_connected'):
        return why_not_reached(run, '/survey', TYPE)
    if answered or run.recording.endpoints('publisher', '/map'):
        return None
    return why_no_endpoint(run, 'publisher', '/map', TYPE)


def keeps_only_the_newest(run: Run) -> None:
    """A subscription that joins after the surveys gets the newest map at once, and no other."""
    lifespans = [end['qos']['lifespan_ns'] for end in run.recording.endpoints('publisher', '/map')]
    for lifespan_ns in filter(None, lifespans):
        raise WHY.failed('lifespan', lifespan_s=lifespan_ns / SECOND)
    # Look only at the student's own maps; a different check tests their text.
    surveys, own = run.asked('maps').inputs, _all_new(run)
    newest = [*surveys, *own][-1]
    # The stored maps of several publishers arrive in any order.
    order = {text: place for place, text in enumerate((FIRST, *surveys))}
    found = sorted(
        texts_of(run.recording.messages('/map', 'late')),
        key=lambda text: (order.get(text, len(order)), text),
    )
    if set(found) != {newest}:
        raise Failed(
            expected=f'the newest map, {_named(run, newest)}, and nothing else, for a late '
            'subscription',
            observed=_shown(run, found),
            why=why_silent(run)
            or _why_unmatched(run, 'late')
            or _why_many(run, len(set(found)))
            or (WHY['first_repeats'] if set(found) == {FIRST} and own else None)
            or _why_other_maps(run),
        )
    # The text of the last map is not judged, only whether it is new.
    last = texts_of(run.recording.messages('/map', 'last'))
    if last and not run.asked('maps').wrong(compared(run)) and {FIRST, *own}.issuperset(last):
        raise WHY.failed('only_if_heard')


def _why_many(run: Run, kept: int) -> Cause | None:
    """Explain why a late subscription gets more than one map."""
    if kept < 2:
        return None
    looks = (graph['when'] for graph in run.recording.of('graph'))
    publishers = max(len(publishers_at(run, when, '/map')) for when in looks)
    if publishers > 1:
        return WHY.of('several_publishers', publishers=publishers)
    return WHY.of('keeps_too_many', about=['map'], kept=kept)


def _named(run: Run, text: str) -> str:
    """Return a name for a map: its text, or the number of its survey if the surveys are secret."""
    surveys = run.asked('maps').inputs
    if run.secret and text in surveys:
        return f'survey {list(dict.fromkeys(surveys)).index(text) + 1}'
    return repr(text) if text == FIRST else safe_quotation(run, text[:40], 'a different text')


def _shown(run: Run, texts: Sequence[str]) -> str:
    """Return maps as text, without revealing which secret survey is sent twice."""
    surveys = run.asked('maps').inputs
    shown = []
    for text, same in groupby(texts):
        count = len(list(same))
        many = count > 2 or text not in surveys or len(texts) > len(surveys)
        often = 'again and again' if many else '' if run.secret else 'twice'
        shown.append(f'{_named(run, text)} {often if count > 1 else ""}'.rstrip())
    return ', '.join(shown[:6]) or 'no map'


def build(surveys: Sequence[str], burst: int = 0) -> Exam:
    """
    Return the exam for some surveys.

    :param surveys: at least three different texts; one has leading or trailing spaces and a
        capital letter, and one is sent twice in a row
    :param burst: number of surveys at the end that are sent at once
    """
    messages = [{'data': text} for text in surveys]
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
                *feeds('/survey', messages, burst, optional=True, rest_s=REST_S),
                Leave('/survey'),
                Advance(ALONE_S),
                Join('late', '/map', TYPE, HISTORY, LISTEN_S),
                *(Leave(name) for name in ('/map', 'early', 'late')),
                Offer('unheard', '/survey', TYPE, Qos()),
                Feed('unheard', [{'data': f'{surveys[-1]} by night'}], optional=True),
                Join('last', '/map', TYPE, HISTORY, LISTEN_S),
            ),
        ),
        read='Part 4: Late subscriptions',
        asks={'maps': Specification(surveys, passed_on(), SLIPS, burst)},
    )
    needs = ['starts_its_node']
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
    exam.check(points=2, needs=needs)(has_a_map_from_the_start)
    exam.check(points=2, needs=needs, read=EXERCISE)(publishes_each_survey)
    exam.check(points=3, needs=needs)(keeps_only_the_newest)
    return exam


exam = build(
    ['hall', ' hall and Cellar  ', 'hall, cellar and yard', 'hall, cellar and yard', 'all of it']
)
