import rclpy
from rclpy.node import Node
from std_msgs.msg import String

ginti = 0
pub = None


def bolo():
    # हर आधे सेकंड में एक बार
    global ginti
    ginti = ginti + 1
    sandesh = String()
    sandesh.data = "hello " + str(ginti)
    pub.publish(sandesh)


def main(args=None):
    global pub
    rclpy.init(args=args)
    node = Node("talker")
    pub = node.create_publisher(String, "chatter", 10)
    node.create_timer(0.5, bolo)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
