import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class Translator(Node):
    """Turns messages of one type into messages of another."""

    source = target = None

    def __init__(self, name):
        super().__init__(name)
        (kind_in, topic_in), (kind_out, topic_out) = self.source, self.target
        publisher = self.create_publisher(kind_out, topic_out, 10)
        self.create_subscription(
            kind_in, topic_in, lambda message: publisher.publish(self.translate(message)), 10
        )

    def translate(self, message):
        raise NotImplementedError('say how')


class Stamping:
    """Gives a message the time of the node."""

    def stamped(self, message):
        message.timestamp = self.get_clock().now().to_msg()
        return message


class MilliReader(Stamping, Translator):
    source = Num, 'raw'
    target = Temperature, 'readings'

    def translate(self, message):
        reading = Temperature(unit='Celsius', sensor_id=message.description)
        reading.temperature_value = message.num / 1e3
        return self.stamped(reading)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(MilliReader('milli_reader'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
