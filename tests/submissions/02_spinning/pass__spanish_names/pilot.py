from functools import partial

from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

VIEJO_NS = 2 * 10 ** 9


class Piloto(Node):
    def __init__(self):
        super().__init__('pilot')
        self.ultimo = {}
        self.ordenes = self.create_publisher(Twist, 'cmd_vel', 10)
        for tema in ('speed', 'turn'):
            self.create_subscription(Float64, tema, partial(self.guardar, tema), 10)
        self.create_timer(0.5, self.conducir)

    def guardar(self, tema, mensaje):
        self.ultimo[tema] = (mensaje.data, self.get_clock().now().nanoseconds)

    def edad_ns(self, tema):
        return self.get_clock().now().nanoseconds - self.ultimo[tema][1]

    def conducir(self):
        if 'speed' not in self.ultimo or 'turn' not in self.ultimo:
            return
        orden = Twist()
        if self.edad_ns('speed') <= VIEJO_NS and self.edad_ns('turn') <= VIEJO_NS:
            orden.linear.x = self.ultimo['speed'][0]
            orden.angular.z = self.ultimo['turn'][0]
        self.ordenes.publish(orden)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Piloto())


if __name__ == '__main__':
    main()
