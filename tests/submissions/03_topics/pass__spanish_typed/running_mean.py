from __future__ import annotations

from dataclasses import dataclass
import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass
class Promedio:
    cuenta: int = 0
    suma: float = 0.0

    def agregar(self, valor: float) -> float | None:
        if math.isnan(valor):
            return None
        self.cuenta += 1
        self.suma += valor
        return self.suma / self.cuenta


class Media(Node):
    def __init__(self) -> None:
        super().__init__('running_mean')
        self.promedio = Promedio()
        self.publicador = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.recibir, 10)

    def recibir(self, mensaje: Float64) -> None:
        if (media := self.promedio.agregar(mensaje.data)) is not None:
            self.publicador.publish(Float64(data=media))


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    nodo = Media()
    try:
        rclpy.spin(nodo)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        nodo.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
