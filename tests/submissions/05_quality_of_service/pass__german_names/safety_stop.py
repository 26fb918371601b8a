import rclpy
from geometry_msgs.msg import Twist as Befehl
from rclpy.node import Node


class Notbremse(Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.ausgang = self.create_publisher(Befehl, 'cmd_vel', 10)
        self.eingang = self.create_subscription(Befehl, 'cmd_vel_raw', self.pruefe, 10)
        self.stille = None

    def pruefe(self, befehl):
        tempo = befehl.linear.x
        befehl.linear.x = 0.5 if tempo > 0.5 else -0.5 if tempo < -0.5 else tempo
        self.ausgang.publish(befehl)
        if self.stille is not None:
            self.destroy_timer(self.stille)
        self.stille = self.create_timer(0.5, self.halte)

    def halte(self):
        self.destroy_timer(self.stille)
        self.stille = None
        self.ausgang.publish(Befehl())


def main():
    rclpy.init()
    rclpy.spin(Notbremse())


if __name__ == '__main__':
    main()
