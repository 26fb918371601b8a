import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature

DEFAULTS = {'factor': 0.001, 'unit': 'Celsius', 'raw_topic': 'raw', 'topic': 'readings'}


class MilliReader(Node):
    def __init__(self, **kwargs):
        super().__init__('milli_reader', **kwargs)
        self.declare_parameters('', list(DEFAULTS.items()))
        self.pub = self.create_publisher(Temperature, self.value('topic'), 10)
        self.sub = self.create_subscription(Num, self.value('raw_topic'), self.on_raw, 10)

    def value(self, name):
        return self.get_parameter(name).value

    def on_raw(self, number):
        self.pub.publish(
            Temperature(
                temperature_value=number.num * self.value('factor'),
                unit=self.value('unit'),
                timestamp=self.get_clock().now().to_msg(),
                sensor_id=number.description,
            )
        )


def main(args=None):
    rclpy.init(args=args)
    node = MilliReader()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
