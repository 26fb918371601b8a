import math

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

REGLES = {
    'limit_c': [
        (math.isfinite, 'la limite doit etre un nombre fini'),
        (lambda limite: limite >= -40.0, 'la limite est trop basse'),
        (lambda limite: limite <= 125.0, 'la limite est trop haute'),
    ],
}


class GardienDeLimite(Node):
    """Surveille un moteur."""

    def __init__(self):
        super().__init__('limit_keeper')
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self.verifier)
        self.abonnement = self.create_subscription(
            Float64, 'motor_temperature', self.recevoir, 10)

    def verifier(self, parametres):
        for parametre in parametres:
            for regle, raison in REGLES.get(parametre.name, []):
                if not regle(parametre.value):
                    self.get_logger().info(f'refuse : {raison}')
                    return SetParametersResult(successful=False, reason=raison)
        return SetParametersResult(successful=True)

    @property
    def limite(self):
        return self.get_parameter('limit_c').get_parameter_value().double_value

    def recevoir(self, message):
        self.get_logger().info(f'{message.data} degres')
        if message.data > self.limite:
            self.get_logger().warning('trop chaud')


def main(args=None):
    rclpy.init(args=args)
    noeud = GardienDeLimite()
    try:
        rclpy.spin(noeud)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        noeud.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
