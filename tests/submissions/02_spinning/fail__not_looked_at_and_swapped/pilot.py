from geometry_msgs.msg import Twist
import rclpy
from std_msgs.msg import Float64


def main():
    rclpy.init()
    node = rclpy.create_node('pilot')
    out = node.create_publisher(Twist, 'cmd_vel', 10)
    latest = {}

    def now():
        return node.get_clock().now().nanoseconds

    def keeper(name):
        def keep(message):
            latest[name] = message.data, now()
        return keep

    def steer():
        if latest.keys() != {'speed', 'turn'}:
            return
        command = Twist()
        if all(now() - when <= 2_000_000_000 for _, when in latest.values()):
            command.linear.x = latest['turn'][0]
            command.angular.z = latest['speed'][0]
        out.publish(command)

    for name in ('speed', 'turn'):
        node.create_subscription(Float64, name, keeper(name), 10)
    node.create_timer(0.5, steer)
    rclpy.spin(node)


main()
