import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.subscription = self.create_subscription(
            Temperature, 'temperature_topic', self.listener_callback, 10
        )

    def listener_callback(self, msg):
        try:
            value = msg.temperature
            if msg.unit == 'Fahrenheit':
                value = (value - 32) * 5 / 9
            elif msg.unit != 'Celsius':
                self.get_logger().error(f'unknown unit: {msg.unit}')
                return
            self.get_logger().info(f'{value:.2f} from {msg.sensor_id}')
            if value > 30.0:
                self.get_logger().warning(f'too hot: {value:.2f}')
        except Exception as error:
            self.get_logger().error(f'something went wrong: {error}')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()
