# Dos nodos en un solo proceso: el vigía y el guardián.
import threading

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Vigilante(Node):
    """Un nodo del puerto que informa con regularidad."""

    def __init__(self, nombre, período, mensaje):
        super().__init__(nombre, namespace='harbour')
        self.mensaje = mensaje
        self.temporizador = self.create_timer(período, self.informar)

    def informar(self):
        self.get_logger().info(self.mensaje)


def girar(ejecutor):
    try:
        ejecutor.spin()
    except ExternalShutdownException:
        pass


def main(args=None):
    rclpy.init(args=args)
    vigía = Vigilante('lookout', 1.0, 'Sin novedad en el mar.')
    guardián = Vigilante('keeper', 2.0, '¡El faro está encendido!')
    ejecutor = SingleThreadedExecutor()
    ejecutor.add_node(vigía)
    ejecutor.add_node(guardián)
    hilo = threading.Thread(target=girar, args=(ejecutor,), daemon=True)
    hilo.start()
    try:
        hilo.join()  # el hilo principal solo espera
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
