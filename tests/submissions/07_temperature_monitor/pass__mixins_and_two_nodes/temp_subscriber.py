import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Speaks:
    def say(self, level, text):
        getattr(self.get_logger(), level)(text)


class Converts:
    def celsius(self, message):
        if message.unit not in ('Celsius', 'Fahrenheit'):
            raise KeyError(message.unit)
        value = message.temperature_value
        return value if message.unit == 'Celsius' else (value - 32) / 1.8


class TemperatureSubscriber(Speaks, Converts, Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.hot = 0
        self.create_subscription(Temperature, 'temperature_topic', self.receive, 10)

    def receive(self, message):
        self.get_logger().info(f'{message.temperature_value:.1f} {message.unit}')
        try:
            celsius = self.celsius(message)
        except KeyError as unit:
            self.get_logger().error(f'unknown unit {unit}')
            return
        if celsius > 30.0:
            self.hot += 1
            self.get_logger().warning(f'{celsius:.1f} °C, number {self.hot}')


def main():
    rclpy.init()
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()
