"""Recordings: queries, and storage in files."""

from dataclasses import replace
import os

from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

from autograder.errors import RecordingInvalid
from autograder.recording import header, Recording, SECOND


def end(topic, kind='publisher', node='/a', kind_of='x/msg/Y'):
    return {'topic': topic, 'kind': kind, 'node': node, 'type': kind_of, 'qos': {}}


SAMPLE = Recording(
    header('talker', 'none'),
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


WHOLE = SAMPLE.to_bytes()


class TestAnswers:
    def test_nodes_are_those_of_every_graph(self):
        assert SAMPLE.nodes == ('/a', '/b')

    def test_endpoints_leave_out_the_plumbing(self):
        """Every node publishes on /rosout, which no check needs."""
        assert [end['topic'] for end in SAMPLE.endpoints('publisher')] == ['/t']
        assert [end['topic'] for end in SAMPLE.endpoints('publisher', '/rosout')] == ['/rosout']

    def test_logs_can_be_asked_by_level(self):
        assert [log['text'] for log in SAMPLE.logs(level=30)] == ['hot']

    def test_late_listeners_are_asked_by_name(self):
        heard = [
            {'event': 'message', 'topic': '/t', 'data': 1},
            {'event': 'message', 'topic': '/t', 'data': 2, 'listener': 'late'},
        ]
        seen = Recording({}, heard)

        assert [event['data'] for event in seen.messages('/t')] == [1]
        assert [event['data'] for event in seen.messages('/t', 'late')] == [2]

    def test_phase_ends_where_the_next_begins(self):
        marks = [{'event': 'mark', 'name': name} for name in ('a', 'b', 'a')]
        logs = [{'event': 'log', 'level': 20, 'text': text} for text in ('0', '1', '2', '3')]
        seen = Recording({}, [logs[0], marks[0], logs[1], marks[1], logs[2], marks[2], logs[3]])

        assert [log['text'] for log in seen.phase('a').logs()] == ['1', '3']
        assert seen.phase('c').events == []

    def test_parts_of_a_phase_last_until_the_next_mark_or_the_end(self):
        times_s = {'a': 1, 'b': 3, 'again': 4}
        marks = [
            {'event': 'mark', 'name': 'b' if name == 'b' else 'a', 'clock_ns': second * SECOND}
            for name, second in times_s.items()
        ]
        seen = Recording({}, [*marks, {'event': 'end', 'clock_ns': 9 * SECOND}])

        assert [seconds for _, seconds in seen.parts('a')] == [2.0, 5.0]

    def test_calls_are_answered_or_not_in_order(self):
        events = [
            {'event': 'answer', 'service': '/a/x', 'data': {}},
            {'event': 'no_answer', 'service': '/a/x', 'reason': 'too_late'},
            {'event': 'answer', 'service': '/a/y', 'data': {}},
        ]

        found = [event['event'] for event in Recording({}, events).answers('/a/x')]

        assert found == ['answer', 'no_answer']

    def test_recording_without_an_end_is_broken_off(self):
        assert Recording({}, ()).end_reason == 'broken_off'


class TestFile:
    def test_saved_recording_loads_equal(self, tmp_path):
        path = tmp_path / 'deep' / 'r.jsonl'
        SAMPLE.save(path)

        loaded = Recording.load(path)

        assert loaded.to_bytes() == WHOLE
        assert [file.name for file in path.parent.iterdir()] == ['r.jsonl']

    def test_second_start_is_kept_apart(self):
        both = replace(SAMPLE, again=replace(SAMPLE, events=SAMPLE.events[-2:]))

        loaded = Recording.from_bytes(both.to_bytes())

        assert loaded.logs() == SAMPLE.logs()
        assert loaded.again.logs() == []
        assert loaded.again.end_reason == 'complete'

    @pytest.mark.parametrize(
        ('data', 'said'),
        [
            (b'', ''),
            (b'[]', ''),
            (b'{"format": "other", "version": 3}\n', ''),
            (b'not json', ''),
            (b'{"a": 1}\n{"b', ''),
            # The times in an older recording are from a different clock.
            (WHOLE.replace(b'"version": 3', b'"version": 1'), r'of version 1\. Try: grade again'),
            (WHOLE + b'42\n', 'not an event'),
            (WHOLE.replace(b'"hot"', b'"hat"'), 'checksum'),
        ],
        ids=['empty', 'list', 'other', 'no json', 'truncated', 'older', 'no event', 'changed'],
    )
    def test_other_file_is_refused(self, tmp_path, data, said):
        (tmp_path / 'r.jsonl').write_bytes(data)

        with pytest.raises(RecordingInvalid, match=rf'r\.jsonl.*{said}'):
            Recording.load(tmp_path / 'r.jsonl')

    @settings(deadline=None)
    @given(cut=st.integers(min_value=0, max_value=len(WHOLE) - 1))
    def test_file_that_was_cut_off_anywhere_is_refused(self, cut):
        with pytest.raises(RecordingInvalid):
            Recording.from_bytes(WHOLE[:cut])

    def test_file_of_a_full_disk_leaves_nothing(self, tmp_path, monkeypatch):
        def refuse(_):
            raise OSError(28, 'No space left on device')

        monkeypatch.setattr(os, 'fsync', refuse)

        with pytest.raises(OSError, match='No space'):
            SAMPLE.save(tmp_path / 'r.jsonl')
        assert list(tmp_path.iterdir()) == []
