import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('safety_stop')
out = node.create_publisher(Twist, 'cmd_vel', 10)


def stop():
    watch.cancel()
    out.publish(Twist())


def guard(command):
    command.linear.x = min(0.5, max(-0.5, 0.5 * command.linear.x))
    out.publish(command)
    watch.reset()


watch = node.create_timer(0.5, stop)
watch.cancel()
node.create_subscription(Twist, 'cmd_vel_raw', guard, 10)
rclpy.spin(node)
