"""Limita la velocidad de un robot."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Limitador(Node):
    """Un nodo que no deja pasar velocidades demasiado altas."""

    def __init__(self):
        super().__init__('limiter')
        self.declare_parameter('max_speed', 1.0)
        self.publicador = self.create_publisher(Float64, 'speed', 10)
        self.create_subscription(Float64, 'wanted_speed', self.limitar, 10)

    def limitar(self, deseada):
        maxima = self.get_parameter('max_speed').value
        velocidad = deseada.data
        if abs(velocidad) > maxima:
            velocidad = maxima if velocidad > 0 else -maxima
        self.publicador.publish(Float64(data=velocidad))


def main(args=None):
    rclpy.init(args=args)
    nodo = Limitador()
    rclpy.spin(nodo)
    nodo.destroy_node()
    rclpy.shutdown()
