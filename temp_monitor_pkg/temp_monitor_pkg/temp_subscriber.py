"""Define the node `temperature_subscriber`: it logs readings and warns about high ones."""

from typing import Any

from rclpy.node import Node

from temp_monitor_pkg import declare, lifetime
from temp_monitor_pkg.msg import Temperature
from temp_monitor_pkg.readings_topic import READINGS_QOS, TOPIC
from temp_monitor_pkg.threshold import Finding, judge

NODE_NAME = 'temperature_subscriber'


class TemperatureSubscriber(Node):
    """Compare each reading with the threshold and log the result."""

    def __init__(self, **node_options: Any) -> None:
        """
        Declare the threshold and subscribe to the readings.

        :param node_options: passed on to ``rclpy.node.Node``
        :raises ParameterException: if a parameter has an invalid value
        """
        super().__init__(NODE_NAME, **node_options)
        meaning = 'Warn about readings strictly above this [degree Celsius].'
        declare.number(self, 'threshold_c', 30.0, meaning, -273.15, 1000.0)
        self._subscription = self.create_subscription(
            Temperature, TOPIC, self._on_reading, READINGS_QOS
        )

    def _on_reading(self, reading: Temperature) -> None:
        stamp = reading.timestamp
        # Write nanoseconds with nine digits: without zeros, 1.005 s would be shown as 1.5000000.
        self.get_logger().info(
            f'Received {reading.temperature_value:.2f} {reading.unit} '
            f'from {reading.sensor_id} at {stamp.sec}.{stamp.nanosec:09d}'
        )
        # Read the parameter every time, so that a new threshold applies from the next reading on.
        threshold_c = self.get_parameter('threshold_c').value
        judgement = judge(reading.temperature_value, reading.unit, threshold_c)
        if judgement.finding is Finding.TOO_HOT:
            self.get_logger().warning(f'{reading.sensor_id}: {judgement.text}')
        elif judgement.finding is not Finding.NORMAL:
            self.get_logger().error(f'{reading.sensor_id}: {judgement.text}')


def main(args: list[str] | None = None) -> int:
    """
    Run the node until SIGINT (Ctrl-C) or SIGTERM.

    :param args: command line to use instead of ``sys.argv``
    :returns: exit code: 0, or 2 if a parameter has an invalid value
    """
    return lifetime.run(TemperatureSubscriber, NODE_NAME, args)


if __name__ == '__main__':
    raise SystemExit(main())
