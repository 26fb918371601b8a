"""Each event is shown as one line, whatever a student's code wrote into it."""

import json
from pathlib import Path

import pytest

from autograder.explaining.live import live_line, WIDEST

SCHEMA = json.loads(
    (Path(__file__).parents[2] / 'docs' / 'recording.schema.json').read_text(encoding='utf-8')
)


def event(kind, clock_ns=None, **facts):
    """Return an event as the probe writes it."""
    return {'event': kind, 'clock_ns': clock_ns, **facts}


@pytest.mark.parametrize(
    ('happened', 'line'),
    [
        (
            event('message', 1_250_000_000, topic='/t', data={'x': 1.5, 'on': True}),
            '    1.250s  /t: x: 1.5, on: true',
        ),
        (
            event('message', 0, topic='/t', data={'stamp': {'sec': 1, 'nanosec': 5}}),
            '    0.000s  /t: stamp: 1.000000005',
        ),
        (
            event('message', 0, topic='/t', data={}, listener='late'),
            '    0.000s  /t (heard by late): ',
        ),
        (
            event('log', 2_000_000_000, name='a', level=30, text='hot\nhot'),
            '    2.000s  [WARN] [a]: hot hot',
        ),
        (event('input', index=3, topic='/t', data={'x': 'nan'}), 'sent 3 on /t: x: "nan"'),
        (event('end', 1, reason='complete'), 'end: complete'),
        (event('process', exit=1, killed='', cpu_s=0.2), 'exit code 1; 0.2 s of processor time'),
        (event('process', exit=None, killed='cpu_limit'), 'ended by the grader: cpu_limit'),
        (
            event('joined', listener='late', topic='/t', matched=False, refused=['RELIABILITY']),
            'late joined /t: matched False, refused for RELIABILITY',
        ),
    ],
)
def test_what_happened_is_one_line(happened, line):
    assert line in live_line(happened)
    assert '\n' not in live_line(happened)


def test_control_characters_do_not_reach_the_terminal():
    """A control character in a log line could clear the screen."""
    line = live_line(event('log', name='a', level=20, text='\x1b[2Jgone'))

    assert '\x1b' not in line
    assert 'gone' in line


def test_long_lines_are_cut():
    """A message may contain an image."""
    assert len(live_line(event('message', topic='/t', data=['x' * 500]))) == WIDEST


def test_every_kind_of_event_has_a_line():
    kinds = [
        kind['properties']['event']['const']
        for kind in SCHEMA['$defs'].values()
        if 'event' in kind.get('properties', {})
    ]
    words = ['when', 'node', 'topic', 'name', 'text', 'service', 'reason', 'listener']
    facts = dict.fromkeys(words, 'x') | dict.fromkeys(['level', 'index', 'exit'], 0)
    facts |= {'nodes': ['/a'], 'endpoints': [], 'refused': [], 'data': {}}
    facts |= {'answered': True, 'matched': True}

    silent = [kind for kind in kinds if not live_line(event(kind, **facts))]

    assert len(kinds) > 15
    assert silent == []
