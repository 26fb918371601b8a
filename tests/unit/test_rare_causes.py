"""Causes that few or no sample submissions show, tested on handmade recordings."""

from dataclasses import replace

import pytest

from autograder.exam.exam import Failed, Run
from autograder.judging.causes import ended
from autograder.recording import ERROR, Recording, WARN
from exams.visible import managed_beacon as beacon
from exams.visible import (
    map_server,
    milli_reader,
    sensor_watch,
    temperature_message,
    temperature_publisher,
)

DISTANCES = replace(sensor_watch.exam.asks['distances'], inputs=(1.25,))
ENDS = ({'event': 'end', 'reason': 'complete'}, {'event': 'process', 'exit': None, 'stdout': ''})


WATCHED = {
    'topic': '/distance',
    'kind': 'subscription',
    'node': sensor_watch.NODE,
    'type': sensor_watch.TYPE,
    'qos': {'deadline_ns': sensor_watch.DEADLINE_NS},
}


def graph(nodes, endpoints=()):
    return {'event': 'graph', 'when': 'end', 'nodes': list(nodes), 'endpoints': list(endpoints)}


def why(check, run):
    with pytest.raises(Failed) as failed:
        check(run)
    return failed.value.why


def test_message_type_that_builds_and_is_another_one():
    end = {
        'topic': '/echo_in',
        'kind': 'subscription',
        'node': '/echo',
        'type': 'temp_monitor_pkg/msg/Temp',
        'qos': {},
    }
    events = (graph(['/echo'], [end]), *ENDS)
    run = Run({}, Recording({}, events), {'sent': [{'unit': 'Celsius'}]})

    found = why(temperature_message.builds_and_travels, run)

    assert found.cause_id == 'different_type'
    assert 'temp_monitor_pkg/msg/Temp' in found.text


@pytest.mark.parametrize(('sent_s', 'cause_id'), [(0.88, ''), (0.96, 'first_map_late')])
def test_first_map_is_there_before_the_node_is_seen(sent_s, cause_id):
    seen = {'event': 'seen', 'clock_ns': 10**9, 'nodes': ['/map_server']}
    first = {
        'event': 'message',
        'topic': '/map',
        'listener': 'early',
        'after_input': None,
        'clock_ns': 15 * 10**8,
        'age_ns': 15 * 10**8 - round(sent_s * 1e9),
        'data': {'data': 'unknown'},
    }
    run = Run({}, Recording({}, (seen, first, *ENDS)), map_server.exam.facts)

    if cause_id:
        assert why(map_server.has_a_map_from_the_start, run).cause_id == cause_id
    else:
        map_server.has_a_map_from_the_start(run)


@pytest.mark.parametrize(
    ('level', 'text', 'printed', 'code', 'cause_id'),
    [
        (None, '', '', '', 'not_logged'),
        (None, '', '', 'log.debug(1)', 'debug_level'),
        (None, '', '1.25 m\n', '', 'print_instead_of_logger'),
        (None, '', '[INFO] [mine]: 1.25 m\n', '', 'other_logger'),
        (WARN, '1.25 m', '', '', 'wrong_level'),
    ],
)
def test_warning_of_silence_does_not_come_instead_of_a_distance(
    level, text, printed, code, cause_id
):
    """The warning is correct, whatever is wrong with the line for the distance."""
    line = {'event': 'log', 'name': 'sensor_watch', 'after_input': 0, 'clock_ns': None}
    silence = {**line, 'level': WARN, 'text': 'No distance in time (1 misses)'}
    logged = [{**line, 'level': level, 'text': text}] if level else []
    sent = {'event': 'input', 'index': 0, 'data': {'data': 1.25}}
    output = f'[WARN] [sensor_watch]: {silence["text"]}\n{printed}'
    ends = (ENDS[0], {**ENDS[1], 'stdout': output})
    events = (graph([sensor_watch.NODE], [WATCHED]), sent, *logged, silence, *ends)
    run = Run({'n.py': code}, Recording({}, events), {'distances': DISTANCES})

    assert why(sensor_watch.logs_each_distance, run).cause_id == cause_id


def warming(values):
    """Return a run of a thermometer that published all these values at the same moment."""
    sent = [
        {
            'event': 'message',
            'topic': temperature_publisher.TOPIC,
            'listener': None,
            'clock_ns': 10**9,
            'data': {'temperature_value': value},
        }
        for value in values
    ]
    return Run({}, Recording({}, (*sent, *ENDS)), {'seconds': 10, 'warming_s': 10.0})


def test_formula_is_not_blamed_for_a_flood():
    temperature_publisher.readings_are_plausible(warming(range(20, 220)))

    found = why(temperature_publisher.readings_are_plausible, warming(range(110, 130)))
    assert found.cause_id == 'implausible'


class TestCausesOfBlindPrograms:
    """Mistakes that were found in programs whose authors did not know the exams."""

    @pytest.mark.parametrize(
        ('numbers', 'values', 'names', 'check', 'cause_id'),
        [
            (
                (1500, -1500, 2500),
                (1.5, -0.5, 2.5),
                ('a', 'b', 'c'),
                milli_reader.divides_by_a_thousand,
                'wrong_below_zero',
            ),
            (  # Python 3.12 and later
                (1500, -1500, 2500),
                (4e-323, 5e-323, 4e-323),
                ('a', 'b', 'c'),
                milli_reader.divides_by_a_thousand,
                'field_value',
            ),
            (
                (1, 2, 3),
                (0.001, 0.002, 0.003),
                ('a', 'unknown', 'c'),
                milli_reader.names_unit_and_sensor,
                'fills_empty',
            ),
        ],
    )
    def test_reader_is_told_which_of_its_messages_are_wrong(
        self, numbers, values, names, check, cause_id
    ):
        facts = milli_reader.build(numbers, ('a', '' if 'unknown' in names else 'b', 'c')).facts
        events = [
            {'event': 'input', 'index': place, 'clock_ns': 0, 'data': {}} for place in range(3)
        ]
        for place, (value, name) in enumerate(zip(values, names)):
            data = {'temperature_value': value, 'sensor_id': name, 'unit': 'Celsius'}
            topic = milli_reader.TARGET
            events.append({'event': 'message', 'topic': topic, 'after_input': place, 'data': data})

        assert why(check, Run({}, Recording({}, (*events, *ENDS)), facts)).cause_id == cause_id

    def test_temperature_that_is_no_number_is_no_formula(self):
        readings = [
            {
                'event': 'message',
                'topic': temperature_publisher.TOPIC,
                'data': {'temperature_value': value},
            }
            for value in (20.0, 21.0, 'nan', 22.0)
        ]
        run = Run({}, Recording({}, (*readings, *ENDS)), temperature_publisher.exam.facts)

        assert why(temperature_publisher.readings_are_plausible, run).cause_id == 'not_finite'

    def test_beacon_that_is_silent_the_second_time_only(self):
        topic = '/beacon_signal'
        beats = [
            {'event': 'message', 'topic': topic, 'clock_ns': round((0.5 + at) * 1e9), 'data': {}}
            for at in range(4)
        ]
        marks = [
            {'event': 'mark', 'name': name, 'clock_ns': round(at * 1e9)}
            for name, at in (('active', 0.0), ('paused', 4.05), ('active again', 6.0))
        ]
        end = {'topic': topic, 'kind': 'publisher', 'node': '/beacon', 'type': beacon.TYPE}
        seen = graph(['/beacon'], [end])
        events = (seen, marks[0], *beats, *marks[1:], *ENDS)
        run = Run({}, Recording({}, events), beacon.exam.facts)

        assert why(beacon.publishes_while_active, run).cause_id == 'mute_again'

    def test_transition_that_is_refused_the_second_time_only(self):
        code = 'def on_configure(self, state):\n    return self.done\n'

        found = ended.why_refused(Run({'n.py': code}, Recording({}, ENDS)), 'configure', True)

        assert found.cause_id == 'refused_again'

    @pytest.mark.parametrize(
        ('first', 'cause_id'),
        [('', 'declared_again'), ('self.undeclare_parameter("a")', 'refused_again')],
    )
    def test_parameter_that_is_declared_in_each_configuration(self, first, cause_id):
        """The program hides the exception, so only the code shows it."""
        code = f'def on_configure(self, state):\n    {first}\n    self.declare_parameter("a", 1)\n'

        found = ended.why_refused(Run({'n.py': code}, Recording({}, ENDS)), 'configure', True)

        assert found.cause_id == cause_id

    def test_second_refusal_alone_is_missing(self):
        """The event has a callback that logs, so the cause is a flag."""
        line = {'event': 'log', 'name': 'sensor_watch', 'after_input': None, 'clock_ns': 1}
        offer = {'event': 'offered', 'matched': False, 'refused': ['DEADLINE'], 'clock_ns': 1}
        events = (
            graph([sensor_watch.NODE], [WATCHED]),
            {'event': 'mark', 'name': 'weak', 'clock_ns': 0},
            {**offer, 'publisher': 'weak'},
            {**line, 'level': ERROR, 'text': 'DEADLINE'},
            {'event': 'mark', 'name': 'weak again', 'clock_ns': 2},
            {**offer, 'publisher': 'weak again', 'clock_ns': 2},
        )
        run = Run({}, Recording({}, (*events, *ENDS)), sensor_watch.exam.facts)

        assert why(sensor_watch.names_the_policy, run).cause_id == 'first_refusal_only'

    def test_node_that_runs_and_is_not_seen(self):
        code = "class N(Node):\n    def __init__(self):\n        super().__init__('n')\n"

        found = ended.why_no_node(Run({'n.py': code}, Recording({}, ENDS)), '/n')

        assert found.cause_id == 'no_node'
