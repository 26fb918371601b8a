"""Simulierter Fühler: veröffentlicht jede Sekunde einen Messwert."""

import random

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Fühler(Node):
    """Ein Thermometer mit einstellbarem Mittelwert."""

    def __init__(self):
        super().__init__('temperature_publisher')
        self.declare_parameter('mittelwert', 24.0)
        self.declare_parameter('periode', 1.0)
        self.sender = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.wecker = self.create_timer(self.get_parameter('periode').value, self.messen)

    def messen(self):
        """Einen Wert messen und senden."""
        nachricht = Temperature()
        nachricht.temperature_value = self.get_parameter('mittelwert').value + random.gauss(0, 3)
        nachricht.unit = 'Celsius'
        nachricht.sensor_id = 'temp_sensor_01'
        nachricht.timestamp = self.get_clock().now().to_msg()
        self.sender.publish(nachricht)
        self.get_logger().info(f'gemessen: {nachricht.temperature_value:.1f} °C')


def main(args=None):
    rclpy.init(args=args)
    fühler = Fühler()
    try:
        rclpy.spin(fühler)
    except KeyboardInterrupt:
        pass
    finally:
        fühler.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
