# Liest Tausendstel Grad und veröffentlicht Grad
import rclpy
from rclpy.node import Node as Knoten
from temp_monitor_pkg.msg import Num as Zahl
from temp_monitor_pkg.msg import Temperature as Messwert

TAUSENDSTEL = 1000.0


class Übersetzer(Knoten):
    def __init__(self):
        super().__init__('milli_reader')
        self.ausgang = self.create_publisher(Messwert, 'readings', 10)
        self.eingang = self.create_subscription(Zahl, 'raw', self.umrechnen, 10)
        self.anzahl = 0

    def umrechnen(self, zahl):
        wert = Messwert()
        wert.temperature_value = zahl.num / TAUSENDSTEL  # Grad
        wert.unit = 'Celsius'
        wert.timestamp = self.get_clock().now().to_msg()  # jetzt
        wert.sensor_id = zahl.description
        self.ausgang.publish(wert)
        self.anzahl += 1
        self.get_logger().info(f'{self.anzahl}. Messwert: {wert.temperature_value} °C')


def main(args=None):
    rclpy.init(args=args)
    knoten = Übersetzer()
    try:
        rclpy.spin(knoten)
    except KeyboardInterrupt:
        print('Tschüss!')


if __name__ == '__main__':
    main()
