"""
Format the events of a run as they happen: messages, log lines and inputs with their time.

Each line has the virtual time [s], then the event.  Text from a student's code is shortened to one
line, and its control characters are replaced.
"""

from collections.abc import Callable, Mapping
import json
from typing import Any

from autograder.explaining.feedback import printable
from autograder.recording import Event, LEVELS, SECOND
from autograder.results import shortened

WIDEST = 110
MOST_DIGITS = 9  # All seventeen digits of a float would leave no room for the rest of the line.


def live_line(event: Event) -> str:
    """Return one event as a line, or an empty string for an event that is not shown."""
    words = _WORDS.get(event['event'])
    what = words(event).replace('\n', ' ') if words else ''
    return shortened(printable(f'{clock(event)}  {what}'), WIDEST) if what else ''


def clock(event: Event) -> str:
    """Return the virtual time of an event, right-aligned; a dash if the clock had not started."""
    now = event.get('clock_ns')
    return f'{"-":>9} ' if now is None else f'{now / SECOND:>9.3f}s'


def _message(event: Event) -> str:
    heard = f' (heard by {event["listener"]})' if event.get('listener') else ''
    if 'too_large' in event:
        return f'{event["topic"]}{heard}: a message of {event["too_large"]} characters'
    return f'{event["topic"]}{heard}: {fields(event["data"])}'


def _graph(event: Event) -> str:
    ends = [
        f'{end["node"]} {"->" if end["kind"] == "publisher" else "<-"} {end["topic"]}'
        for end in event['endpoints']
        if not end['topic'].endswith(('/rosout', '/parameter_events'))
    ]
    seen = ', '.join(ends[:6]) or ', '.join(event['nodes'][:6]) or 'no node'
    return f'graph at {event["when"]}: {seen}'


def _connection_line(event: Event) -> str:
    name = event.get('listener') or event.get('publisher')
    refused = f', refused for {event["refused"][0]}' if event['refused'] else ''
    return f'{name} {event["event"]} {event["topic"]}: matched {event["matched"]}{refused}'


def _process(event: Event) -> str:
    end = f'ended by the grader: {event["killed"]}' if event.get('killed') else ''
    end = end or ('still running' if event['exit'] is None else f'exit code {event["exit"]}')
    return f'the program: {end}; {event.get("cpu_s", 0)} s of processor time'


def fields(data: Any) -> str:
    """Return the fields of a message in one line, without quotes around their names."""
    if isinstance(data, Mapping):
        return ', '.join(f'{name}: {_value(value)}' for name, value in data.items())
    return _value(data)


def _value(value: Any) -> str:
    if isinstance(value, Mapping) and set(value) == {'sec', 'nanosec'}:
        return f'{value["sec"]}.{value["nanosec"]:09d}'
    if isinstance(value, Mapping):
        return '{' + fields(value) + '}'
    if isinstance(value, float) and len(repr(value)) > MOST_DIGITS + 1:
        return f'{value:.{MOST_DIGITS}g}'
    return json.dumps(value, ensure_ascii=False)


_WORDS: dict[str, Callable[[Event], str]] = {
    'seen': lambda event: f'nodes: {", ".join(event["nodes"])}',
    'asked': lambda event: (
        f'{event["node"]} {"answers" if event["answered"] else "does not answer"}'
    ),
    'graph': _graph,
    'message': _message,
    'log': lambda event: (
        f'[{LEVELS.get(event["level"], event["level"])}] [{event["name"]}]: {event["text"]}'
    ),
    'input': lambda event: f'sent {event["index"]} on {event["topic"]}: {fields(event["data"])}',
    'answer': lambda event: f'{event["service"]} answers: {fields(event["data"])}',
    'no_answer': lambda event: f'{event["service"]}: no answer ({event["reason"]})',
    'joined': _connection_line,
    'offered': _connection_line,
    'left': lambda event: f'{event["name"]} left',
    'watched': lambda event: f'subscribed to {event["topic"]} again',
    'mark': lambda event: f'-- {event["name"]} --',
    'again': lambda _: '-- the program is started a second time --',
    'imitated': lambda _: "a node with the same name as the grader's node",
    'not_connected': lambda event: f'no node is connected to {event["topic"]}',
    'end': lambda event: f'end: {event["reason"]}',
    'process': _process,
}
