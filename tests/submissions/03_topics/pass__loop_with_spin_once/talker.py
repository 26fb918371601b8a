import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
import time
def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('talker')
    pub = node.create_publisher(String, 'chatter', 10)
    i = 0
    while rclpy.ok():
        i += 1
        pub.publish(String(data=f'hello {i}'))
        rclpy.spin_once(node, timeout_sec=0)
        time.sleep(0.5)
main()
