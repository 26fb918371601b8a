import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor


def watcher(name, period):
    node = rclpy.create_node(name, namespace='/harbour')

    def report():
        text = name + ' is awake'
        if name == 'keeper':
            print(text)
        else:
            node.get_logger().info(text)

    node.create_timer(period, report)
    return node


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(watcher('lookout', 1.0))
    executor.add_node(watcher('keeper', 2.0))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()
