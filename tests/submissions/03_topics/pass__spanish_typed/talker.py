from __future__ import annotations

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.timer import Timer
from std_msgs.msg import String


class Hablador(Node):
    """Saluda dos veces por segundo."""

    def __init__(self) -> None:
        super().__init__('talker')
        self.declare_parameter('frecuencia', 2.0)
        frecuencia: float = self.get_parameter('frecuencia').value
        self._número: int = 0
        self._publicador: Publisher = self.create_publisher(String, 'chatter', 10)
        self._reloj: Timer = self.create_timer(1.0 / frecuencia, self._saludar)

    def _saludar(self) -> None:
        self._número += 1
        mensaje = String(data=f'hello {self._número}')
        self._publicador.publish(mensaje)


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    nodo = Hablador()
    try:
        rclpy.spin(nodo)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        nodo.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
