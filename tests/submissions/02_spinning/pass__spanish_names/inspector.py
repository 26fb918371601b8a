import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(imagen):
    """Mira una imagen; tarda 1,2 segundos."""
    time.sleep(1.2)
    return imagen.upper()


class Inspector(Node):
    """Un nodo con un latido que no espera."""

    def __init__(self):
        super().__init__('inspector')
        self.grupo_del_latido = MutuallyExclusiveCallbackGroup()
        self.grupo_lento = MutuallyExclusiveCallbackGroup()
        self.vivo = self.create_publisher(Empty, 'alive', 10)
        self.resultados = self.create_publisher(String, 'results', 10)
        self.reloj = self.create_timer(0.5, self.latir, callback_group=self.grupo_del_latido)
        self.oyente = self.create_subscription(
            String, 'pictures', self.mirar, 10, callback_group=self.grupo_lento)

    def latir(self):
        self.vivo.publish(Empty())

    def mirar(self, mensaje):
        respuesta = inspect(mensaje.data)
        self.get_logger().info(f'visto: {respuesta}')
        self.resultados.publish(String(data=respuesta))


def main(args=None):
    rclpy.init(args=args)
    nodo = Inspector()
    ejecutor = MultiThreadedExecutor(num_threads=3)
    ejecutor.add_node(nodo)
    try:
        while rclpy.ok():
            ejecutor.spin_once()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
