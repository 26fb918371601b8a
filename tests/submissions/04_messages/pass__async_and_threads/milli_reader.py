import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    def __init__(self):
        super().__init__('milli_reader')
        group = ReentrantCallbackGroup()
        self.out = self.create_publisher(Temperature, 'readings', 10)
        self.create_subscription(Num, 'raw', self.convert, 10, callback_group=group)

    async def reading(self, number):
        msg = Temperature(unit='Celsius')
        msg.timestamp = self.get_clock().now().to_msg()
        msg.temperature_value = float(number.num) / 1000.0
        msg.sensor_id = str(number.description)
        return msg

    async def convert(self, number):
        self.out.publish(await self.reading(number))


def main(args=None):
    rclpy.init(args=args)
    node = MilliReader()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
