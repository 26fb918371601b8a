"""Define the node `temperature_publisher`: a simulated sensor that publishes its readings."""

from dataclasses import dataclass, fields, replace
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter

from temp_monitor_pkg import declare, lifetime
from temp_monitor_pkg.heating_profile import Heating, SENSOR_MAX_C, SENSOR_MIN_C, SimulatedSensor
from temp_monitor_pkg.msg import Temperature
from temp_monitor_pkg.readings_topic import READINGS_QOS, TOPIC
from temp_monitor_pkg.units import CELSIUS, from_celsius, UNITS

NODE_NAME = 'temperature_publisher'


@dataclass(frozen=True)
class Settings:
    """The values of the node's parameters; each field has the name of its parameter."""

    rate_hz: float
    unit: str
    sensor_id: str
    coolest_c: float
    warmest_c: float
    cycle_s: float

    def heating(self) -> Heating:
        """
        Return the heating cycle that these settings describe.

        :returns: the cycle for the simulated sensor
        """
        return Heating(self.coolest_c, self.warmest_c, self.cycle_s)

    def problem(self) -> str:
        """
        Return what is wrong with these settings beyond the ranges of individual parameters.

        :returns: one sentence, empty if nothing is wrong
        """
        if self.unit not in UNITS:
            return f'unit must be one of {", ".join(UNITS)}, got {self.unit!r}'
        if not self.sensor_id.strip():
            return 'sensor_id must not be empty, or readers cannot tell the sensors apart'
        return self.heating().problem()


class TemperaturePublisher(Node):
    """Publish one simulated reading per period."""

    def __init__(self, **node_options: Any) -> None:
        """
        Declare the parameters and start the timer.

        :param node_options: passed on to ``rclpy.node.Node``
        :raises ParameterException: if a parameter has an invalid value
        """
        super().__init__(NODE_NAME, **node_options)
        self._settings = self._declare_settings()
        seed = declare.fixed_integer(
            self, 'seed', -1, 'Seed of the random numbers; -1 for a random seed.', -1, 2**31 - 1
        )
        problem = self._settings.problem()
        if problem:
            raise ParameterException('Parameter refused', problem)
        self._sensor = SimulatedSensor(self._settings.heating(), None if seed < 0 else seed)
        self._publisher = self.create_publisher(Temperature, TOPIC, READINGS_QOS)
        self._timer = self._create_timer()
        self.add_on_set_parameters_callback(self._check_parameters)
        self.add_post_set_parameters_callback(self._apply_parameters)

    def _declare_settings(self) -> Settings:
        coldest, hottest = SENSOR_MIN_C, SENSOR_MAX_C
        return Settings(
            rate_hz=declare.number(self, 'rate_hz', 1.0, 'Readings per second [Hz].', 0.1, 100.0),
            unit=declare.text(
                self, 'unit', CELSIUS, 'Unit of the readings.', f'one of {", ".join(UNITS)}'
            ),
            sensor_id=declare.text(
                self, 'sensor_id', 'temp_sensor_01', 'Name of the sensor.', 'not empty'
            ),
            coolest_c=declare.number(
                self, 'coolest_c', 21.0, 'Start of a cycle [degree Celsius].', coldest, hottest
            ),
            warmest_c=declare.number(
                self, 'warmest_c', 34.0, 'Middle of a cycle [degree Celsius].', coldest, hottest
            ),
            cycle_s=declare.number(
                self, 'cycle_s', 90.0, 'Duration of one heating cycle [s].', 1.0, 86400.0
            ),
        )

    def _changed(self, parameters: list[Parameter]) -> Settings:
        ours = {field.name for field in fields(Settings)}
        return replace(self._settings, **{p.name: p.value for p in parameters if p.name in ours})

    def _check_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        problem = self._changed(parameters).problem()
        return SetParametersResult(successful=not problem, reason=problem)

    def _apply_parameters(self, parameters: list[Parameter]) -> None:
        before, self._settings = self._settings, self._changed(parameters)
        self._sensor.heating = self._settings.heating()
        if self._settings.rate_hz != before.rate_hz:
            self.destroy_timer(self._timer)
            self._timer = self._create_timer()

    def _create_timer(self) -> Any:
        # create_timer uses the node's clock: with use_sim_time, readings slow and stop with it.
        return self.create_timer(1.0 / self._settings.rate_hz, self._publish_reading)

    def _publish_reading(self) -> None:
        settings = self._settings
        reading = Temperature()
        reading.temperature_value = from_celsius(self._sensor.read(), settings.unit)
        reading.unit = settings.unit
        reading.timestamp = self.get_clock().now().to_msg()
        reading.sensor_id = settings.sensor_id
        self._publisher.publish(reading)
        self.get_logger().info(
            f'Published {reading.temperature_value:.2f} {reading.unit} from {reading.sensor_id}'
        )
        # Advance by the nominal period, not the clock: a seed gives the same series on any
        # machine.
        self._sensor.advance(1.0 / settings.rate_hz)


def main(args: list[str] | None = None) -> int:
    """
    Run the node until SIGINT (Ctrl-C) or SIGTERM.

    :param args: command line to use instead of ``sys.argv``
    :returns: exit code: 0, or 2 if a parameter has an invalid value
    """
    return lifetime.run(TemperaturePublisher, NODE_NAME, args)


if __name__ == '__main__':
    raise SystemExit(main())
