# Wächter: meldet Abstände, Stille und unpassende Sender
import rclpy
from rclpy.duration import Duration as Dauer
from rclpy.event_handler import SubscriptionEventCallbacks as Ereignisse
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind as name_der_regel
from rclpy.qos import QoSProfile as Profil
from rclpy.qos import ReliabilityPolicy as Zuverlässigkeit
from std_msgs.msg import Float64 as Zahl

FRIST = Dauer(seconds=0.3)  # höchstens so lange darf es still sein


class Wächter(Node):
    def __init__(self):
        super().__init__('sensor_watch')
        profil = Profil(
            depth=5, reliability=Zuverlässigkeit.BEST_EFFORT, deadline=FRIST
        )
        ereignisse = Ereignisse(deadline=self.zu_still, incompatible_qos=self.unpassend)
        self.create_subscription(
            Zahl, 'distance', self.gehört, profil, event_callbacks=ereignisse
        )
        self.get_logger().info('Wächter läuft')

    def gehört(self, nachricht):
        self.get_logger().info(f'Abstand: {nachricht.data} m')

    def zu_still(self, ereignis):
        self.get_logger().warn(f'Seit über 0,3 s nichts gehört ({ereignis.total_count}×)')

    def unpassend(self, ereignis):
        regel = name_der_regel(ereignis.last_policy_kind)
        self.get_logger().error(f'Der Sender verspricht zu wenig: {regel}')


def main(args=None):
    rclpy.init(args=args)
    knoten = Wächter()
    try:
        rclpy.spin(knoten)
    except KeyboardInterrupt:
        print('Tschüss!')


if __name__ == '__main__':
    main()
