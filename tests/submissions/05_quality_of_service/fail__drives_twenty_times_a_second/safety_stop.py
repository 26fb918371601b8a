import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('safety_stop')
out = node.create_publisher(Twist, 'cmd_vel', 10)
latest = []


def stop():
    watch.cancel()
    latest.clear()
    out.publish(Twist())


def guard(command):
    command.linear.x = min(0.5, max(-0.5, command.linear.x))
    latest[:] = [command]
    watch.reset()


def drive():
    for command in latest:
        out.publish(command)


watch = node.create_timer(0.5, stop)
watch.cancel()
node.create_timer(0.05, drive)
node.create_subscription(Twist, 'cmd_vel_raw', guard, 10)
rclpy.spin(node)
