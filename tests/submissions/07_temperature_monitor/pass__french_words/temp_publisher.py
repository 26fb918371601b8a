"""Capteur simulé."""

from random import gauss

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Capteur(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.éditeur = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.horloge = self.create_timer(1.0, self.mesurer)

    def mesurer(self):
        """Prendre une mesure et la publier."""
        mesure = Temperature()
        mesure.temperature_value = gauss(mu=26.0, sigma=2.0)
        mesure.unit = 'Celsius'
        mesure.timestamp = self.get_clock().now().to_msg()
        mesure.sensor_id = 'temp_sensor_01'
        self.éditeur.publish(mesure)
        self.get_logger().info(f'publié : {mesure.temperature_value:.1f} °C')


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Capteur())
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
