"""Recordings: what they answer, and how they are kept."""

from __future__ import annotations

import pytest

from autograder.errors import RecordingInvalid
from autograder.recording import header, Recording


def end(topic, kind='publisher', node='/a', kind_of='x/msg/Y'):
    """Return an endpoint as the probe writes it."""
    return {'topic': topic, 'kind': kind, 'node': node, 'type': kind_of, 'qos': {}}


SAMPLE = Recording(
    header('talker', 'plain'),
    (
        {'event': 'graph', 'when': 'start', 'nodes': ['/b'], 'endpoints': [end('/t')]},
        {'event': 'input', 'index': 0},
        {'event': 'log', 'level': 20, 'text': 'hello', 'after_input': 0},
        {'event': 'log', 'level': 30, 'text': 'hot', 'after_input': 1},
        {'event': 'message', 'topic': '/t', 'data': {'value': 'nan'}},
        {
            'event': 'graph',
            'when': 'end',
            'nodes': ['/a', '/b'],
            'endpoints': [end('/t'), end('/rosout'), end('/u', 'subscription')],
        },
        {'event': 'end', 'reason': 'complete'},
        {'event': 'process', 'exit': None, 'killed': ''},
    ),
)


class TestAnswers:
    """The questions checks ask."""

    def test_nodes_are_those_of_every_graph(self):
        """A node that came or went in between is still known."""
        assert SAMPLE.nodes == ('/a', '/b')

    def test_endpoints_leave_out_the_plumbing(self):
        """Every node publishes on /rosout; nobody asks for it."""
        assert [end['topic'] for end in SAMPLE.endpoints('publisher')] == ['/t']
        assert [end['topic'] for end in SAMPLE.endpoints('publisher', '/rosout')] == ['/rosout']

    def test_logs_can_be_asked_by_level_and_input(self):
        """Both filters hold at once."""
        assert [log['text'] for log in SAMPLE.logs(level=30)] == ['hot']
        assert [log['text'] for log in SAMPLE.logs(level=30, after_input=0)] == []

    def test_recording_without_an_end_is_broken_off(self):
        """Absence of the last event is itself a fact."""
        assert Recording({}, ()).end_reason == 'broken_off'


class TestFile:
    """A file is whole, ours and of this version, or it is refused."""

    def test_saved_recording_loads_equal(self, tmp_path):
        """Saving and loading changes nothing."""
        path = tmp_path / 'deep' / 'r.jsonl'
        SAMPLE.save(path)

        loaded = Recording.load(path)

        assert list(loaded.lines()) == list(SAMPLE.lines())
        assert [file.name for file in path.parent.iterdir()] == ['r.jsonl']

    @pytest.mark.parametrize(
        'text',
        ['', '[]', '{"format": "other", "version": 1}\n', 'not json', '{"a": 1}\n{"b'],
        ids=['empty', 'list', 'other format', 'no json', 'truncated'],
    )
    def test_other_file_is_refused(self, tmp_path, text):
        """Nothing is judged from a file that is not a whole recording."""
        path = tmp_path / 'r.jsonl'
        path.write_text(text, encoding='utf-8')

        with pytest.raises(RecordingInvalid, match=r'r\.jsonl'):
            Recording.load(path)

    def test_line_that_is_no_event_is_refused(self, tmp_path):
        """A damaged line is not skipped."""
        path = tmp_path / 'r.jsonl'
        SAMPLE.save(path)
        path.write_text(path.read_text(encoding='utf-8') + '42\n', encoding='utf-8')

        with pytest.raises(RecordingInvalid, match='no event'):
            Recording.load(path)
