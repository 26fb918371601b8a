"""
Select the data for the picture of a failed check, in JSON types.

There are two kinds of pictures: a *timeline* of messages and log lines that arrived too rarely,
too often or too late, and a *graph* of nodes and topics that do not connect.  They show names,
times and counts, but never a value that was sent or received.  For a hidden exam, they do not show
which input a message followed, because the order of the inputs is secret.  They also hide the
drawn namespace, and round times to a tenth of a second.  Long lists of times are thinned and
long names are shortened.  :mod:`autograder.explaining.picture_svg` draws the pictures.
"""

from collections.abc import Iterable, Mapping, Sequence
import json
import re
from typing import Any

from autograder.exam.exam import Check, Exam, Failed, Run
from autograder.exam.scenario import Scenario
from autograder.judging.causes.redaction import namespace_of
from autograder.judging.checks import own_logs
from autograder.judging.judge import deviation, failure_of
from autograder.recording import Event, LEVELS, SECOND
from autograder.results import CheckResult, Verdict

MOST_TIMES = 400
MOST_ROWS = 6
MOST_PERIODS = 24
"""Maximum number of periods that a picture of a rhythm shows, as part of a longer run."""
MOST_ARROWS = 8
MOST_EVENTS = 20_000
"""In a recording with more events, a difference is shown only if the check itself names it."""
LONGEST_NAME = 80
LISTENING, SENDING = 'the checks, listening', 'the checks, sending'

# Matches an expectation that begins with a number of messages, lines or the like.
_AMOUNT = re.compile(
    r'^(?:at least |at most |exactly |about )?(?:\d+|no|one|two|three|four|five)\b.{0,40}?'
    r'\b(?:message|reading|line|warning|greeting|answer|text)s?\b',
    re.IGNORECASE,
)
_LEVEL = re.compile(r'\b(DEBUG|INFO|WARN|ERROR|FATAL)')
_NUMBERS = {word: level for level, word in LEVELS.items()}


def pictures(exam: Exam, run: Run, results: Sequence[CheckResult]) -> dict[str, Mapping[str, Any]]:
    """Return the pictures of failed checks, by the name of the check; equal pictures only once."""
    found: dict[str, Mapping[str, Any]] = {}
    shown: set[str] = set()
    for check, result in zip(exam.checks, results):
        seen, scenario = check.run_of(run), exam.scenario_of(check)
        if result.verdict is not Verdict.FAILED or check.static or not seen.recording.nodes:
            continue
        try:
            picture = _connections(scenario, seen, result)
            picture = picture or _timeline(scenario, check, seen, result)
            if exam.hidden and picture:
                picture = _without_secrets(scenario, picture)
        except Exception:  # noqa: BLE001 - A failed picture must not prevent the verdict.
            continue
        text = json.dumps(picture, sort_keys=True)
        if picture and text not in shown:
            found[check.name] = picture
            shown.add(text)
    return found


def _without_secrets(scenario: Scenario, picture: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """
    Return a picture of a hidden exam without its drawn namespace and with rounded times.

    Return None for a timeline by inputs, because the order of the inputs is secret.
    """
    if picture.get('unit') == 'input':
        return None
    text = json.dumps(picture, ensure_ascii=False)
    if space := namespace_of(scenario):
        text = text.replace(space, '\N{HORIZONTAL ELLIPSIS}')
    shown: dict[str, Any] = json.loads(text)
    for row in shown.get('rows', []):
        row['times'] = [round(time, 1) for time in row['times']]
    if shown.get('deviation') is not None:
        shown['deviation'] = round(shown['deviation'], 1)
    return shown


# -- graph -----------------------------------------------------------------------------------


def _wanted(scenario: Scenario) -> list[tuple[str, str, str]]:
    """
    Return the publishers and subscriptions that a scenario requires: kind, topic, type.

    If several topics have the same last part, such as ``/lab/chatter`` and ``/chatter``, the exam
    requires the first; the probe watches the others to detect a mistake.
    """
    found: dict[tuple[str, str], tuple[str, str, str]] = {}
    for kind, topic, type_name in (one for one in scenario.endpoints() if one[0] != 'service'):
        found.setdefault((kind, topic.rpartition('/')[2]), (kind, topic, type_name))
    return list(found.values())


def _connections(scenario: Scenario, run: Run, result: CheckResult) -> Mapping[str, Any] | None:
    """Return the graph of connections, if the check failed because a connection is missing."""
    arrows: list[dict[str, Any]] = []
    wanted = _wanted(scenario)
    about = ' '.join((result.title, result.expected, result.observed, result.cause))
    named = [end for end in wanted if _names(about, end[1])]
    for kind, topic, type_name in named or (wanted if _about_qos(result) else []):
        ends = run.recording.endpoints(kind, topic)
        reason = _reason(scenario, run, result, ends, topic, type_name)
        if not reason:
            continue
        node = ends[0]['node'] if ends else run.recording.nodes[0]
        outward = kind == 'publisher'
        arrows.append(_arrow(node, topic, type_name, outward, False, reason))
        us = LISTENING if outward else SENDING
        arrows.append(_arrow(us, topic, type_name, not outward, bool(ends), ''))
        right = {one for _, one, _ in wanted}
        others = [end for end in run.recording.endpoints(kind) if end['topic'] not in right]
        arrows += [
            _arrow(end['node'], end['topic'], end['type'], outward, True, 'not required')
            for end in others[:3]
        ]
    if not arrows:
        return None
    unique = {json.dumps(arrow, sort_keys=True): arrow for arrow in arrows}
    return {'kind': 'graph', 'arrows': list(unique.values())[:MOST_ARROWS]}


def _reason(
    scenario: Scenario,
    run: Run,
    result: CheckResult,
    ends: Sequence[Event],
    topic: str,
    type_name: str,
) -> str:
    """Return why an endpoint differs from the required one; empty if it does not."""
    if not ends:
        return 'expected here, but missing'
    if not any(end['type'] == type_name for end in ends):
        return f'expected {type_name}, but yours is {ends[0]["type"][:LONGEST_NAME]}'
    about = [event for event in run.recording.events if event.get('topic') == topic]
    refused = [
        event for event in about if event['event'] == 'not_connected' or event.get('refused')
    ]
    said = f'{result.expected} {result.cause} {result.try_this}'.upper()
    if topic in scenario.watch:
        # The plain subscription is connected; the node may have to refuse other subscriptions.
        refused = [event for event in refused if any(one in said for one in event['refused'])]
    if any(event['event'] == 'offered' and event['matched'] for event in about):
        # The node must refuse one of the grader's publishers, whose QoS profile is too weak.
        refused = []
    if _about_qos(result) and 'subscription' not in result.expected:
        return f'expected {result.expected}, observed {result.observed}'[:120]
    if not refused and not _about_qos(result):
        return ''
    qos = ends[0]['qos']
    yours = f'yours is {qos["reliability"]}, {qos["durability"]}'
    return f'the quality of service does not match; {yours}'


def _about_qos(result: CheckResult) -> bool:
    return result.cause_id.startswith('qos')


def _names(text: str, topic: str) -> bool:
    """Return whether a text mentions a topic, by its full name or its last part."""
    return re.search(rf'(?<![\w]){re.escape(topic.rpartition("/")[2])}(?!\w)', text) is not None


def _arrow(
    node: str, topic: str, type_name: str, outward: bool, matched: bool, remark: str
) -> dict[str, Any]:
    names = {'node': node, 'topic': topic, 'type': type_name}
    shortened = {key: name[:LONGEST_NAME] for key, name in names.items()}
    return {**shortened, 'outward': outward, 'matched': matched, 'remark': remark}


# -- timeline --------------------------------------------------------------------------------


def _timeline(
    scenario: Scenario, check: Check, run: Run, result: CheckResult
) -> Mapping[str, Any] | None:
    """Return a timeline of events, if the check failed because of a count or a time."""
    failure = failure_of(check, run)
    if failure is None or (failure.at is None and not _AMOUNT.match(failure.expected)):
        return None
    inputs, clock = run.recording.of('input'), scenario.ros_clock
    unit, rate = ('ros_seconds', clock.rate) if clock else ('seconds', 1.0)
    if inputs and failure.every_s is None:
        if len(inputs) == 1:
            return None  # a picture of one input adds nothing to the check's sentence
        unit, rate = 'input', 0.0
    rows = _rows(scenario, run, result, rate)
    shown = [time for row in rows for time in row['times']]
    at = _first_difference(check, run, failure, rate)
    if rate:
        begin, end = 0.0, max([*shown, *_moments(run.recording.events, rate)], default=0.0)
    else:  # a line may precede all inputs, and the first difference may be at an unsent input
        shown += [] if at is None else [at]
        begin, end = min([1.0, *shown]), max([float(len(inputs)), *shown])
    if not rows or end <= begin:
        return None
    if failure.every_s:
        every_s = round(rate * failure.every_s, 3)
        begin, end = _window(begin, end, every_s, at)
        rows.insert(0, _due(every_s, rows, end))
    within = (
        {**row, 'times': _thinned([time for time in row['times'] if begin <= time <= end])}
        for row in rows[:MOST_ROWS]
    )
    return {
        'kind': 'timeline',
        'unit': unit,
        'begin': round(begin, 3),
        'end': round(end, 3),
        'rows': list(within),
        'deviation': at,
    }


def _window(begin: float, end: float, every_s: float, at: float | None) -> tuple[float, float]:
    """Return the beginning and end to show: for a long run, some periods around the difference."""
    if end - begin <= MOST_PERIODS * every_s:
        return begin, end
    first = max(begin, (begin if at is None else at) - MOST_PERIODS / 3 * every_s)
    first = min(first, end - MOST_PERIODS * every_s)
    return first, first + MOST_PERIODS * every_s


def _rows(scenario: Scenario, run: Run, result: CheckResult, rate: float) -> list[dict[str, Any]]:
    """Return the rows for inputs, and for the log lines or the messages that a check is about."""
    recording, about = run.recording, f'{result.title} {result.expected}'
    offered = {one['publisher']: one['topic'] for one in recording.of('offered')}
    sent: dict[str, list[Event]] = {}
    for event in () if rate else recording.of('input'):
        topic = str(offered.get(event['topic'], event['topic']))
        sent.setdefault(topic, []).append(event)
    shown: dict[str, list[Event]] = {}
    named = _named(recording.nodes, result.expected, about)
    for level in dict.fromkeys(_LEVEL.findall(about)):
        row, value = f'{level} lines', _NUMBERS[level]
        if len(recording.nodes) == 1:
            shown[row] = own_logs(run, recording.nodes[0], value)
        elif named:
            shown |= {f'{row} of {node}': own_logs(run, node, value) for node in named}
        else:
            shown[row] = recording.logs(level=value)
    if not shown:
        topics = [topic for topic in scenario.watch if recording.messages(topic)]
        topics = topics or [topic for topic in scenario.watch if _names(about, topic)][:1]
        shown = {topic: recording.messages(topic) for topic in topics[:3]}
    rows = [(f'sent on {topic}', 'sent', events) for topic, events in sent.items()]
    rows += [(label, 'observed', events) for label, events in shown.items()]
    return [_row(label, what, _moments(events, rate)) for label, what, events in rows]


def _named(nodes: Sequence[str], expected: str, about: str) -> Sequence[str]:
    """Return the nodes with the full name in an expectation, else with the last part in a text."""
    # A name may be the beginning of a longer one.
    full = [node for node in nodes if re.search(rf'{re.escape(node)}(?![\w/])', expected)]
    return full or [node for node in nodes if _names(about, node)]


def _moments(events: Iterable[Event], rate: float) -> list[float]:
    """
    Return the positions of events on the axis of the picture.

    :param rate: seconds of the axis per virtual second; 0 for an axis with the number of the last
        input before each event, which is 0 before the first input
    """
    if rate:
        moments = (event.get('clock_ns') for event in events)
        return [moment / SECOND * rate for moment in moments if moment is not None]
    after = (event.get('index', event.get('after_input', ...)) for event in events)
    return [0.0 if index is None else index + 1.0 for index in after if index is not ...]


def _row(label: str, what: str, times: Sequence[float]) -> dict[str, Any]:
    found = [round(float(time), 3) for time in sorted(times)]
    return {'label': label[:LONGEST_NAME], 'what': what, 'count': len(times), 'times': found}


def _thinned(times: Sequence[float]) -> Sequence[float]:
    """Return at most :data:`MOST_TIMES` of the times in a picture."""
    return times[:: -(-len(times) // MOST_TIMES) or 1]


def _due(every_s: float, rows: Sequence[Mapping[str, Any]], end: float) -> dict[str, Any]:
    """Return the row of expected times, aligned with the first observed time."""
    first = next((row['times'][0] % every_s for row in rows if row['times']), 0.0) or every_s
    count = int((end - first) / every_s + 1e-6) + 1
    due = [first + number * every_s for number in range(max(count, 1))][-2 * MOST_PERIODS :]
    return {**_row('expected', 'expected', due), 'every_s': every_s}


def _first_difference(check: Check, run: Run, failure: Failed, rate: float) -> float | None:
    """Return the position of the first difference on the axis of the picture; None if unknown."""
    events = run.recording.events
    if failure.place is not None and not rate:
        return failure.place + 1.0
    if failure.at is not None:
        return round(failure.at / SECOND * rate, 3) if rate else None
    if failure.every_s:
        return None  # no message arrived, so every expected time is a difference
    where = deviation(check, run) if len(events) <= MOST_EVENTS else None
    found = _moments([events[where.index]], rate) if where and where.how == 'cut' else []
    return round(found[0], 3) if found else None
