"""Causes that few or no sample submissions show, tested on handmade recordings."""

from dataclasses import replace

from handmade_runs import at, cause_id_of, graph, message, publisher, run_of, sent, why
import pytest

from autograder.judging.causes import ended
from autograder.recording import ERROR, WARN
from exams.visible import managed_beacon as beacon
from exams.visible import (
    map_server,
    milli_reader,
    sensor_watch,
    temperature_message,
    temperature_publisher,
)

DISTANCES = replace(sensor_watch.exam.asks['distances'], inputs=(1.25,))
SENSOR = graph(
    publisher(
        '/distance',
        sensor_watch.NODE,
        sensor_watch.TYPE,
        kind='subscription',
        qos={'deadline_ns': sensor_watch.DEADLINE_NS},
    )
)


def logged(level, text, after_input=None):
    return at(0.0, 'log', name='sensor_watch', level=level, text=text, after_input=after_input)


def test_message_type_that_builds_and_is_another_one():
    other = 'temp_monitor_pkg/msg/Temp'
    end = publisher('/echo_in', '/echo', other, kind='subscription', qos={})
    run = run_of(graph(end), facts={'sent': [{'unit': 'Celsius'}]})

    found = why(temperature_message.builds_and_travels, run)

    assert found.cause_id == 'different_type'
    assert other in found.text


@pytest.mark.parametrize(('sent_s', 'cause_id'), [(0.88, None), (0.96, 'first_map_late')])
def test_first_map_is_there_before_the_node_is_seen(sent_s, cause_id):
    seen = at(1.0, 'seen', nodes=['/map_server'])
    first = message(1.5, '/map', {'data': 'unknown'}, listener='early', after_input=None)
    first['age_ns'] = 15 * 10**8 - round(sent_s * 1e9)
    run = run_of(seen, first, facts=map_server.exam.facts)

    assert cause_id_of(map_server.has_a_map_from_the_start, run) == cause_id


@pytest.mark.parametrize(
    ('logs', 'printed', 'code', 'cause_id'),
    [
        ([], '', '', 'not_logged'),
        ([], '', 'log.debug(1)', 'debug_level'),
        ([], '1.25 m\n', '', 'print_instead_of_logger'),
        ([], '[INFO] [mine]: 1.25 m\n', '', 'other_logger'),
        ([logged(WARN, '1.25 m', 0)], '', '', 'wrong_level'),
    ],
)
def test_warning_of_silence_does_not_come_instead_of_a_distance(logs, printed, code, cause_id):
    """The warning is correct, whatever is wrong with the line for the distance."""
    silence = logged(WARN, 'No distance in time (1 misses)', 0)
    inputs = [at(0.0, 'input', index=0, data={'data': 1.25})]
    output = f'[WARN] [sensor_watch]: {silence["text"]}\n{printed}'
    events = (SENSOR, *inputs, *logs, silence)
    run = run_of(*events, code=code, facts={'distances': DISTANCES}, stdout=output)

    assert why(sensor_watch.logs_each_distance, run).cause_id == cause_id


FLOOD = {'seconds': 10, 'warming_s': 10.0}


@pytest.mark.parametrize(
    ('values', 'facts', 'cause_id'),
    [
        (range(20, 220), FLOOD, None),
        (range(110, 130), FLOOD, 'implausible'),
        ((20.0, 21.0, 'nan', 22.0), temperature_publisher.exam.facts, 'not_finite'),
    ],
    ids=['flood of plausible values', 'too hot', 'not a number'],
)
def test_formula_is_blamed_only_for_numbers_out_of_range(values, facts, cause_id):
    """All messages come at the same moment; only as many as expected are judged."""
    topic = temperature_publisher.TOPIC
    readings = [
        message(1.0, topic, {'temperature_value': value}, listener=None) for value in values
    ]
    run = run_of(*readings, facts=facts)

    assert cause_id_of(temperature_publisher.readings_are_plausible, run) == cause_id


class TestCausesOfBlindPrograms:
    """Mistakes that were found in programs whose authors did not know the exams."""

    @pytest.mark.parametrize(
        ('numbers', 'values', 'cause_id'),
        [
            ((1500, -1500, 2500), (1.5, -0.5, 2.5), 'wrong_below_zero'),
            # Python 3.12 and later, if the program assigns an int.
            ((1500, -1500, 2500), (4e-323, 5e-323, 4e-323), 'field_value'),
        ],
    )
    def test_reader_is_told_which_of_its_messages_are_wrong(self, numbers, values, cause_id):
        run = self.reader(numbers, ('a', 'b', 'c'), values, ('a', 'b', 'c'))

        assert why(milli_reader.divides_by_a_thousand, run).cause_id == cause_id

    def test_reader_that_fills_an_empty_description_is_told(self):
        run = self.reader((1, 2, 3), ('a', '', 'c'), (0.001, 0.002, 0.003), ('a', 'unknown', 'c'))

        assert why(milli_reader.names_unit_and_sensor, run).cause_id == 'fills_empty'

    @staticmethod
    def reader(numbers, names, values, sensors):
        """Return a run of the reader, which publishes values of sensors."""
        read = [
            message(
                0.0,
                milli_reader.TARGET,
                {'temperature_value': value, 'sensor_id': sensor, 'unit': 'Celsius'},
                after_input=place,
            )
            for place, (value, sensor) in enumerate(zip(values, sensors))
        ]
        return run_of(*sent(0.0, 0.0, 0.0), *read, facts=milli_reader.build(numbers, names).facts)

    def test_beacon_that_is_silent_the_second_time_only(self):
        topic = '/beacon_signal'
        seen = graph(publisher(topic, '/beacon', beacon.TYPE))
        beats = [message(0.5 + number, topic) for number in range(4)]
        begin, *later = (
            at(clock, 'mark', name=name)
            for name, clock in (('active', 0.0), ('paused', 4.05), ('active again', 6.0))
        )
        run = run_of(seen, begin, *beats, *later, facts=beacon.exam.facts)

        assert why(beacon.publishes_while_active, run).cause_id == 'mute_again'

    @pytest.mark.parametrize(
        ('body', 'cause_id'),
        [
            ('return self.done', 'refused_again'),
            # The program hides the exception, so only the code shows it.
            ('self.declare_parameter("a", 1)', 'declared_again'),
            ('self.undeclare_parameter("a")\n    self.declare_parameter("a", 1)', 'refused_again'),
        ],
    )
    def test_transition_that_is_refused_the_second_time_only(self, body, cause_id):
        run = run_of(code=f'def on_configure(self, state):\n    {body}\n')

        assert ended.why_refused(run, 'configure', True).cause_id == cause_id

    def test_second_refusal_alone_is_missing(self):
        """The event has a callback that logs, so the cause is a flag."""
        offer = {'matched': False, 'refused': ['DEADLINE']}
        run = run_of(
            SENSOR,
            at(0.0, 'mark', name='weak'),
            at(0.0, 'offered', publisher='weak', **offer),
            logged(ERROR, 'DEADLINE'),
            at(2.0, 'mark', name='weak again'),
            at(2.0, 'offered', publisher='weak again', **offer),
            facts=sensor_watch.exam.facts,
        )

        assert why(sensor_watch.names_the_policy, run).cause_id == 'first_refusal_only'

    def test_node_that_runs_and_is_not_seen(self):
        code = "class N(Node):\n    def __init__(self):\n        super().__init__('n')\n"

        assert ended.why_no_node(run_of(code=code), '/n').cause_id == 'no_node'
