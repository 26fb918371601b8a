import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


def report(node, text):
    return lambda: node.get_logger().info(text)


def main():
    rclpy.init()
    lookout = Node('lookout', namespace='harbour')
    keeper = Node('keeper', namespace='harbour')
    lookout.create_timer(1.0, report(lookout, 'all clear'))
    keeper.create_timer(2.0, report(keeper, 'the lamp burns'))
    executor = MultiThreadedExecutor()
    executor.add_node(lookout)
    executor.add_node(keeper)
    while rclpy.ok():
        executor.spin_once(timeout_sec=0.1)


main()
