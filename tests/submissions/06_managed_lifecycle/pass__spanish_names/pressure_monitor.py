"""Vigila la presión."""

import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class Vigilante(LifecycleNode):
    """Avisa si la presión pasa del límite."""

    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.límite = 0.0
        self.vigilando = False
        self.oído = self.create_subscription(Float64, 'pressure', self.juzgar, 10)

    def on_configure(self, estado):
        límite = self.get_parameter('limit').value
        if not límite > 0:
            self.get_logger().error('límite sin sentido: {} bar'.format(límite))
            return TransitionCallbackReturn.FAILURE
        self.límite = límite
        return super().on_configure(estado)

    def on_activate(self, estado):
        self.vigilando = True
        return super().on_activate(estado)

    def on_deactivate(self, estado):
        self.vigilando = False
        return super().on_deactivate(estado)

    def juzgar(self, mensaje):
        presión = mensaje.data
        if self.vigilando:
            if presión > self.límite:
                self.get_logger().warn('¡cuidado! {:.1f} bar'.format(presión))
            else:
                self.get_logger().info('todo bien: {:.1f} bar'.format(presión))


def main(args=None):
    rclpy.init(args=args)
    vigilante = Vigilante()
    try:
        rclpy.spin(vigilante)
    except KeyboardInterrupt:
        print('adiós')
    finally:
        vigilante.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
