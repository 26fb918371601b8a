from __future__ import annotations

from dataclasses import dataclass

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


@dataclass
class Paquete:
    texto: str
    entregado: bool = False


class Mensajero(Node):
    def __init__(self, paquete: Paquete) -> None:
        super().__init__('courier')
        self.paquete = paquete
        self.publicador = self.create_publisher(String, 'parcels', 10)
        self.temporizador = self.create_timer(0.2, self.mirar)

    @property
    def hay_alguien(self) -> bool:
        return self.publicador.get_subscription_count() > 0

    def mirar(self) -> None:
        if self.hay_alguien and not self.paquete.entregado:
            self.paquete.entregado = True
            self.publicador.publish(String(data=self.paquete.texto))
            self.get_logger().info('¡Entregado!')
            self.temporizador.cancel()


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    nodo = Mensajero(Paquete('for you'))
    try:
        rclpy.spin(nodo)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        nodo.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
