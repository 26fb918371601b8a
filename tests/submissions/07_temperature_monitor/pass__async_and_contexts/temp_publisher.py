import itertools

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Thermometer(Node):
    def __init__(self, context):
        super().__init__('temperature_publisher', context=context)
        self.values = itertools.cycle((19.5, 21.0, 24.25, 31.5))
        self.out = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(1.0, self.tick)

    async def tick(self):
        self.out.publish(await self.measure())

    async def measure(self):
        stamp = self.get_clock().now().to_msg()
        return Temperature(
            temperature_value=next(self.values),
            unit='Celsius',
            timestamp=stamp,
            sensor_id='temp_sensor_01',
        )


def main():
    with Context() as context:
        with SingleThreadedExecutor(context=context) as executor:
            executor.add_node(Thermometer(context))
            try:
                executor.spin()
            except (KeyboardInterrupt, ExternalShutdownException):
                pass


if __name__ == '__main__':
    main()
