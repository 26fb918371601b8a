import rclpy
from rclpy.node import Node

i = 0
node = None


def callback():
    global i
    global node
    i = i + 1
    msg = "This is watch number " + str(i) + " of the night, at " + str(i) + " seconds."
    if i in [5, 10, 15]:
        node.get_logger().warn(msg)
    else:
        node.get_logger().info(msg)


def main(args=None):
    global node
    rclpy.init(args=args)
    node = Node("night_watch")
    timer = node.create_timer(1.0, callback)
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
