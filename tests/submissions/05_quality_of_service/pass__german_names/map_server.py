# Kartenserver: merkt sich die neueste Karte für Nachzügler
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy as Dauerhaftigkeit
from rclpy.qos import QoSProfile as Profil
from rclpy.qos import ReliabilityPolicy as Zuverlässigkeit
from std_msgs.msg import String as Text


class Kartenserver(Node):
    def __init__(self):
        super().__init__('map_server')
        # eine Karte genügt, und zwar die letzte
        profil = Profil(
            depth=1,
            durability=Dauerhaftigkeit.TRANSIENT_LOCAL,
            reliability=Zuverlässigkeit.RELIABLE,
        )
        self.verteiler = self.create_publisher(Text, 'map', profil)
        self.vermessung = self.create_subscription(Text, 'survey', self.übernehmen, 10)
        self.veröffentlichen('unknown')

    def übernehmen(self, nachricht):
        # unverändert weitergeben
        self.veröffentlichen(nachricht.data)

    def veröffentlichen(self, inhalt):
        karte = Text()
        karte.data = inhalt
        self.verteiler.publish(karte)


def main(args=None):
    rclpy.init(args=args)
    knoten = Kartenserver()
    try:
        rclpy.spin(knoten)
    except KeyboardInterrupt:
        print('Tschüss!')


if __name__ == '__main__':
    main()
