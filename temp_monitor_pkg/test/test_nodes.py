"""Test both nodes from outside, each in an isolated ROS environment: topics, logs, parameters."""

import math
from typing import Any

import pytest
from rcl_interfaces.msg import Log, ParameterType
from rclpy.exceptions import ParameterException
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from temp_monitor_pkg import temp_publisher, temp_subscriber
from temp_monitor_pkg.msg import Temperature
from temp_monitor_pkg.temp_publisher import TemperaturePublisher
from temp_monitor_pkg.temp_subscriber import TemperatureSubscriber

INFO, WARN, ERROR = LoggingSeverity.INFO, LoggingSeverity.WARN, LoggingSeverity.ERROR


def set_one(node: Any, name: str, value: Any) -> Any:
    """Set one parameter and return the node's response."""
    return node.set_parameters([Parameter(name, value=value)])[0]


class SimulatedTime:
    """Advances /clock in steps of 0.1 s."""

    def __init__(self, world, node: Any) -> None:
        self._world, self._node = world, node
        self._clock = world.probe.create_publisher(Clock, '/clock', 10)
        self._tenths = 0

    def advance(self, seconds: int) -> None:
        """Advance the clock, and let the node run after every step."""
        for _ in range(10 * seconds):
            self._tenths += 1
            message = Clock()
            message.clock.sec = self._tenths // 10
            message.clock.nanosec = self._tenths % 10 * 100_000_000
            self._clock.publish(message)
            wanted = self._tenths * 100_000_000
            self._world.spin_until(
                lambda wanted=wanted: self._node.get_clock().now().nanoseconds >= wanted,
                'the node follows /clock',
            )
            # The timer is due now: let it and the subscriptions run.
            for _ in range(5):
                self._world.executor.spin_once(timeout_sec=0)


class TestPublisher:
    """The node temperature_publisher."""

    def test_reading_has_all_fields(self, world) -> None:
        """A reading contains the value, the unit, the sensor and the node's current time."""
        readings = world.listen('temperature_topic', Temperature)
        node = world.start(TemperaturePublisher, rate_hz=50.0)
        before = node.get_clock().now().nanoseconds
        world.spin_until(lambda: readings, 'one reading')
        stamp = readings[0].timestamp

        assert (readings[0].unit, readings[0].sensor_id) == ('Celsius', 'temp_sensor_01')
        assert -40.0 <= readings[0].temperature_value <= 125.0
        stamp_ns = stamp.sec * 10**9 + stamp.nanosec
        assert before < stamp_ns <= node.get_clock().now().nanoseconds

    def test_endpoint_has_the_agreed_name_and_quality(self, world) -> None:
        """The topic has a relative name and a reliable, volatile QoS profile."""
        node = world.start(TemperaturePublisher)
        (endpoint,) = node.get_publishers_info_by_topic('temperature_topic')

        assert node.get_name() == 'temperature_publisher'
        assert endpoint.topic_type == 'temp_monitor_pkg/msg/Temperature'
        assert endpoint.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        assert endpoint.qos_profile.durability is DurabilityPolicy.VOLATILE

    def test_simulated_time_one_reading_each_second(self, world) -> None:
        """With use_sim_time, the timer and the stamps follow /clock exactly."""
        readings = world.listen('temperature_topic', Temperature)
        node = world.start(TemperaturePublisher, use_sim_time=True)
        SimulatedTime(world, node).advance(seconds=5)

        stamps = [(reading.timestamp.sec, reading.timestamp.nanosec) for reading in readings]
        assert stamps == [(second, 0) for second in range(1, 6)]

    def test_new_rate_remakes_the_timer(self, world) -> None:
        """A rate that is set while the node runs applies immediately, and replaces the timer."""
        readings = world.listen('temperature_topic', Temperature)
        node = world.start(TemperaturePublisher, use_sim_time=True)
        time = SimulatedTime(world, node)
        time.advance(seconds=3)
        readings.clear()

        assert set_one(node, 'rate_hz', 2.0).successful
        time.advance(seconds=3)

        assert len(readings) == 6
        assert [timer.timer_period_ns for timer in node.timers] == [500_000_000]

    def test_unit_can_change_while_running(self, world) -> None:
        """A new unit applies from the next reading on."""
        readings = world.listen('temperature_topic', Temperature)
        node = world.start(TemperaturePublisher, rate_hz=100.0)
        world.spin_until(lambda: readings, 'a reading')

        assert set_one(node, 'unit', 'Fahrenheit').successful
        world.spin_until(lambda: readings[-1].unit == 'Fahrenheit', 'a reading in Fahrenheit')

        assert 66.0 < readings[-1].temperature_value < 74.0  # about 21 degrees Celsius

    @pytest.mark.parametrize(
        ('name', 'value', 'reason'),
        [
            ('rate_hz', 0.0, 'Min: 0.1'),
            ('rate_hz', 101.0, 'Max: 100.0'),
            ('rate_hz', math.nan, 'out of range'),
            ('rate_hz', 2, 'DOUBLE'),
            ('unit', 'Kelvin', 'Celsius, Fahrenheit'),
            ('unit', 5, 'STRING'),
            ('sensor_id', ' ', 'empty'),
            ('coolest_c', 34.0, 'below warmest_c'),
            ('warmest_c', 126.0, 'Max: 125.0'),
            ('cycle_s', 0.5, 'Min: 1.0'),
            ('seed', 3, 'read-only'),
        ],
    )
    def test_bad_value_is_refused_with_the_reason(
        self, world, name: str, value: Any, reason: str
    ) -> None:
        """An invalid value changes nothing, and the response states the allowed values."""
        node = world.start(TemperaturePublisher)
        before = node.get_parameter(name).value
        answer = set_one(node, name, value)

        assert not answer.successful
        assert reason in answer.reason
        assert node.get_parameter(name).value == before

    def test_values_that_fit_together_are_set_together(self, world) -> None:
        """Two limits can be set in one request even if one of them would be invalid alone."""
        node = world.start(TemperaturePublisher)
        bounds = [Parameter('coolest_c', value=50.0), Parameter('warmest_c', value=60.0)]

        assert not set_one(node, 'coolest_c', 50.0).successful
        assert node.set_parameters_atomically(bounds).successful

    @pytest.mark.parametrize(
        ('name', 'value'),
        [('rate_hz', -1.0), ('rate_hz', 1), ('unit', 'Kelvin'), ('seed', -2), ('sensor_id', '')],
    )
    def test_bad_value_at_the_start_stops_the_node(self, world, name: str, value: Any) -> None:
        """A node with an invalid parameter does not start."""
        with pytest.raises(ParameterException, match=name):
            world.start(TemperaturePublisher, **{name: value})


class TestSubscriber:
    """The node temperature_subscriber."""

    @staticmethod
    def send(world, *readings: tuple[float, str]) -> list[Log]:
        """Publish readings and an extra one; return the log lines once the node has logged it."""
        publisher = world.probe.create_publisher(Temperature, 'temperature_topic', 10)
        for value, unit in [*readings, (0.0, 'Celsius')]:
            message = Temperature(temperature_value=value, unit=unit, sensor_id='lab')
            message.timestamp.sec, message.timestamp.nanosec = 1, 5_000_000
            publisher.publish(message)

        def lines() -> list[Log]:
            return [log for log in world.logs if log.name == 'temperature_subscriber']

        world.spin_until(lambda: any(' 0.00 ' in log.msg for log in lines()), 'the last reading')
        return lines()[:-1]

    @pytest.mark.parametrize(
        ('value', 'unit', 'levels'),
        [
            (25.0, 'Celsius', [INFO]),
            (30.0, 'Celsius', [INFO]),
            (math.nextafter(30.0, 31.0), 'Celsius', [INFO, WARN]),
            (-12.5, 'Celsius', [INFO]),
            (86.0, 'Fahrenheit', [INFO]),
            (90.0, 'Fahrenheit', [INFO, WARN]),
            (35.0, 'Kelvin', [INFO, ERROR]),
            (math.nan, 'Celsius', [INFO, ERROR]),
            (math.inf, 'Celsius', [INFO, WARN]),
        ],
    )
    def test_reading_is_logged_and_judged(
        self, world, value: float, unit: str, levels: list[int]
    ) -> None:
        """Each reading gives an INFO line, a high one also a WARN, an invalid one an ERROR too."""
        world.start(TemperatureSubscriber)
        logs = self.send(world, (value, unit))

        assert [log.level for log in logs] == levels
        assert f'{value:.2f} {unit} from lab at 1.005000000' in logs[0].msg

    def test_burst_gives_one_warning_for_each_hot_reading(self, world) -> None:
        """Each high reading gives a separate warning."""
        world.start(TemperatureSubscriber)
        logs = self.send(world, *[(value, 'Celsius') for value in (31.0, 29.0, 31.0, 31.0)])

        assert [log.level for log in logs] == [INFO, WARN, INFO, INFO, WARN, INFO, WARN]

    def test_new_threshold_counts_from_the_next_reading(self, world) -> None:
        """The threshold can be set at the start and changed while the node runs."""
        node = world.start(TemperatureSubscriber, threshold_c=20.0)
        logs = self.send(world, (25.0, 'Celsius'))
        world.logs.clear()
        answer = set_one(node, 'threshold_c', 25.0)
        later = self.send(world, (25.0, 'Celsius'))

        assert answer.successful
        assert [log.level for log in logs] == [INFO, WARN]
        assert [log.level for log in later] == [INFO]

    @pytest.mark.parametrize('value', [math.nan, math.inf, -300.0, 31])
    def test_bad_threshold_is_refused(self, world, value: float) -> None:
        """A threshold that is not finite, out of range or an integer is refused with a reason."""
        node = world.start(TemperatureSubscriber)
        answer = set_one(node, 'threshold_c', value)

        assert not answer.successful
        assert answer.reason
        assert node.get_parameter('threshold_c').value == 30.0


class TestVirtualTime:
    """Test the nodes as programs on a virtual clock, where a minute takes less than a second."""

    def test_heating_cycle_has_a_reading_each_second(self, virtual_time) -> None:
        """The default rate is exact; reading, log line and stamp agree."""
        run = virtual_time(temp_publisher.__file__, seconds=90)
        readings = run.messages('temperature_topic')
        stamps = [reading.timestamp for reading in readings]

        assert run.times('temperature_topic') == [float(second) for second in range(1, 91)]
        assert [line.time_s for line in run.logs] == run.times('temperature_topic')
        assert [stamp.sec - stamps[0].sec for stamp in stamps] == list(range(90))
        assert max(reading.temperature_value for reading in readings) > 30.0

    def test_same_seed_same_series(self, virtual_time) -> None:
        """Two programs with the same seed publish equal values at equal times."""
        first, again, other = (
            virtual_time(temp_publisher.__file__, seconds=30, arguments=['-p', f'seed:={seed}'])
            for seed in (7, 7, 8)
        )

        assert first == again
        assert first != other

    def test_cycle_of_the_publisher_warns_once_for_each_hot_reading(self, virtual_time) -> None:
        """The subscriber gets each reading when it is published, and warns once per high one."""
        readings = virtual_time(temp_publisher.__file__, seconds=90)['temperature_topic']
        sent = list(zip(readings.times, readings.messages))
        run = virtual_time(temp_subscriber.__file__, 91, inputs={'temperature_topic': sent})

        hot = [second for second, reading in sent if reading.temperature_value > 30.0]
        assert 10 < len(hot) < 60
        assert [line.time_s for line in run.logged('WARN')] == hot
        assert [line.time_s for line in run.logged('INFO')] == list(readings.times)


@pytest.mark.parametrize('node_class', [TemperaturePublisher, TemperatureSubscriber])
def test_every_parameter_describes_itself(world, node_class: type) -> None:
    """Each parameter of the package has a description and limits; numbers have a range."""
    node = world.start(node_class)
    ours = [name for name in node.get_parameters_by_prefix('') if '.' not in name]
    ours = [n for n in ours if n not in ('use_sim_time', 'start_type_description_service')]

    assert ours
    for descriptor in node.describe_parameters(ours):
        assert descriptor.description.endswith('.')
        assert descriptor.additional_constraints
        if descriptor.type == ParameterType.PARAMETER_DOUBLE:
            assert descriptor.floating_point_range
            assert descriptor.name.endswith(('_c', '_s', '_hz'))


def test_namespace_moves_both_nodes_together(world) -> None:
    """The topic's name is relative: in a namespace, the two nodes still discover each other."""
    readings = world.listen('/hall/temperature_topic', Temperature)
    for node_class in (TemperaturePublisher, TemperatureSubscriber):
        node = node_class(context=world.context, namespace='hall')
        world.adopt(node)
    publisher, subscriber = world.nodes[-2:]
    assert set_one(publisher, 'rate_hz', 100.0).successful
    world.spin_until(lambda: readings, 'a reading in the namespace')

    assert subscriber.count_publishers('temperature_topic') == 1
