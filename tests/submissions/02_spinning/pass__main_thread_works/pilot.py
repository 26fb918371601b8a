import threading
import time

from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


def main():
    rclpy.init()
    node = Node('pilot')
    out = node.create_publisher(Twist, 'cmd_vel', 10)
    seen = {}
    node.create_subscription(
        Float64, 'speed', lambda m: seen.update(speed=(m.data, time.time())), 10)
    node.create_subscription(
        Float64, 'turn', lambda m: seen.update(turn=(m.data, time.time())), 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    rate = node.create_rate(2.0)
    while rclpy.ok():
        rate.sleep()
        if len(seen) == 2:
            (speed, at), (turn, then) = seen['speed'], seen['turn']
            twist = Twist()
            if time.time() - min(at, then) <= 2:
                twist.linear.x, twist.angular.z = speed, turn
            out.publish(twist)


if __name__ == '__main__':
    main()
