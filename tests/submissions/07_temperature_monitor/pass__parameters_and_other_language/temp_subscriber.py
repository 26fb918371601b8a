"""Wächter: warnt, wenn es zu warm wird."""

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

UMRECHNEN = {
    'Celsius': lambda wert: wert,
    'Fahrenheit': lambda wert: (wert - 32) * 5 / 9,
}


class Wächter(Node):
    """Vergleicht jeden Messwert mit der Schwelle."""

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.declare_parameter('schwelle', 30.0)
        self.empfang = self.create_subscription(
            Temperature, 'temperature_topic', self.empfangen, 10
        )

    def empfangen(self, nachricht):
        """Einen Messwert protokollieren und beurteilen."""
        wert, einheit = nachricht.temperature_value, nachricht.unit
        self.get_logger().info(f'Messwert {wert:.2f} {einheit} von {nachricht.sensor_id}')
        if einheit not in UMRECHNEN:
            self.get_logger().error(f'unbekannte Einheit {einheit!r}')
            return
        celsius = UMRECHNEN[einheit](wert)
        if celsius > self.get_parameter('schwelle').value:
            self.get_logger().warning(f'zu warm: {celsius:.1f} °C')


def main(args=None):
    rclpy.init(args=args)
    wächter = Wächter()
    try:
        rclpy.spin(wächter)
    except KeyboardInterrupt:
        pass
    finally:
        wächter.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
