# La ronda nocturna: cuenta las guardias, y cada quinta vez habla más fuerte.
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class RondaNocturna(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.número = 0
        self.cerrojo = threading.Lock()
        self.temporizador = self.create_timer(1.0, self.informar)

    def informar(self):
        with self.cerrojo:
            self.número += 1
            número = self.número
        if número % 5 == 0:
            self.get_logger().warning(f'Guardia n.º {número}: ¿quién me releva?')
        else:
            self.get_logger().info(f'Guardia n.º {número}: todo tranquilo.')


def girar(nodo):
    try:
        rclpy.spin(nodo)
    except ExternalShutdownException:
        pass


def main(args=None):
    rclpy.init(args=args)
    nodo = RondaNocturna()
    hilo = threading.Thread(target=girar, args=(nodo,))
    hilo.start()
    try:
        hilo.join()
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
