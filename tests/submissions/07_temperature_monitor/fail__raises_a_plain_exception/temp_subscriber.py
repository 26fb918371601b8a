#!/usr/bin/env python3
"""Watch a thermometer and warn when it gets too warm."""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

THRESHOLD_C = 30.0


def to_celsius(value, unit):
    """
    Convert a reading to degrees Celsius.

    :param value: temperature, in the given unit
    :param unit: 'Celsius' or 'Fahrenheit'
    :returns: the same temperature [degC]
    :raises ValueError: if the unit is any other text
    """
    # 1. Return the value as it is, or converted: C = (F - 32) * 5 / 9.
    # 2. Raise ValueError, with the unit in its text, for anything else.

    if unit == 'Celsius':
        return value
    if unit == 'Fahrenheit':
        return (value - 32.0) * 5.0 / 9.0
    raise Exception('unknown unit')



class TemperatureSubscriber(Node):
    """A monitor that logs each reading and warns above the threshold."""

    def __init__(self):
        """Create the node and its subscription."""
        # 3. Hand the node name to the parent class.
        # 4. create_subscription(type, topic, the method to call, depth)

        super().__init__('temperature_subscriber')
        self.create_subscription(Temperature, 'temperature_topic', self.judge_reading, 10)


    def judge_reading(self, message):
        """
        Log one reading, and warn if it is strictly above the threshold.

        :param message: the Temperature that has arrived
        """
        log = self.get_logger()
        # 5. log.info: the value, the unit and the sensor, as they arrived.
        # 6. Convert with to_celsius. On ValueError: log.error, and return.
        # 7. Strictly above THRESHOLD_C: log.warning.

        log.info(f'{message.temperature_value:.2f} {message.unit} from {message.sensor_id}')
        celsius = to_celsius(message.temperature_value, message.unit)
        if celsius > THRESHOLD_C:
            log.warning(f'Too warm: {celsius:.2f} degC is above {THRESHOLD_C} degC')



def main(args=None):
    """Run the node until it is interrupted or terminated."""
    # 8. The same pattern as in the publisher.

    rclpy.init(args=args)
    node = TemperatureSubscriber()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()



if __name__ == '__main__':
    sys.exit(main())
