from functools import partial

import rclpy
from geometry_msgs.msg import Twist, Vector3


def make_stop():
    return Twist(linear=Vector3(), angular=Vector3())


def guard(publisher, timer, command):
    speed = max(-0.5, min(0.5, command.linear.x))
    publisher.publish(Twist(linear=Vector3(x=speed), angular=Vector3(z=command.angular.z)))
    timer.reset()


def make_node():
    node = rclpy.create_node('safety_stop')
    publisher = node.create_publisher(Twist, 'cmd_vel', 10)

    def stop():
        timer.cancel()
        publisher.publish(make_stop())

    timer = node.create_timer(0.5, stop, autostart=False)
    node.create_subscription(Twist, 'cmd_vel_raw', partial(guard, publisher, timer), 10)
    return node


def main():
    rclpy.init()
    rclpy.spin(make_node())


if __name__ == '__main__':
    main()
