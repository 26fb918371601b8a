import threading
import time

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.hot = False
        self.create_subscription(Temperature, 'temperature_topic', self.listen, 10)
        threading.Thread(target=self.remind, daemon=True).start()

    def listen(self, reading):
        self.get_logger().info(f'{reading.temperature_value:.2f} {reading.unit}')
        celsius = reading.temperature_value
        if reading.unit == 'Fahrenheit':
            celsius = (celsius - 32.0) * 5.0 / 9.0
        elif reading.unit != 'Celsius':
            self.get_logger().error(f'unknown unit {reading.unit}')
            return
        if celsius > 30.0:
            self.get_logger().warning(f'{celsius:.1f} °C is too hot')
            self.hot = True

    def remind(self):
        while rclpy.ok():
            time.sleep(1.0)
            if self.hot:
                self.get_logger().warning('it was too hot')



def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()
