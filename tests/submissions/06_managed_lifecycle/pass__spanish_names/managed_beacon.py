"""Baliza con ciclo de vida: sólo parpadea cuando está activa."""

import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String

PERIODO = 1.0  # segundos


class Baliza(LifecycleNode):
    """Una baliza."""

    def __init__(self):
        super().__init__('beacon')
        self.número = 0

    def on_configure(self, estado):
        # aquí nace todo lo que la baliza necesita
        self.emisor = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.reloj = self.create_timer(PERIODO, self.parpadear)
        self.get_logger().info('configurada')
        return super().on_configure(estado)

    def on_cleanup(self, estado):
        # y aquí muere
        self.destroy_timer(self.reloj)
        self.destroy_lifecycle_publisher(self.emisor)
        self.número = 0
        return super().on_cleanup(estado)

    def parpadear(self):
        self.número += 1
        señal = String()
        señal.data = f'señal número {self.número}'
        self.emisor.publish(señal)


def main(args=None):
    rclpy.init(args=args)
    baliza = Baliza()
    try:
        rclpy.spin(baliza)
    except KeyboardInterrupt:
        print('adiós')
    finally:
        baliza.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
