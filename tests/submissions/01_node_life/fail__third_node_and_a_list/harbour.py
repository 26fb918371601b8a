import rclpy
from rclpy.node import Node
from rclpy.executors import MultiThreadedExecutor

lookout = None
keeper = None


def lookout_callback():
    global lookout
    # print("lookout")
    lookout.get_logger().info("lookout says hello")


def keeper_callback():
    global keeper
    # print("keeper")
    keeper.get_logger().info("keeper says hello")


def main(args=None):
    global lookout, keeper
    rclpy.init(args=args)

    lookout = Node("lookout", namespace="harbour")
    keeper = Node("keeper", namespace="harbour")
    timer1 = lookout.create_timer(1.0, lookout_callback)
    timer2 = keeper.create_timer(2.0, keeper_callback)

    office = Node("office", namespace="harbour")
    office.get_logger().info("open")

    executor = MultiThreadedExecutor()
    executor.add_node(office)
    executor.add_node(lookout)
    executor.add_node(keeper)
    executor.spin()

    lookout.destroy_node()
    keeper.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
