import rclpy
from rclpy.node import Node
from std_msgs.msg import String

pub = None
timer = None


def dekho():
    # कोई सुन रहा है?
    log = pub.get_subscription_count()
    if log >= 1:
        pub.publish(String(data="for you"))
        timer.cancel()


def main(args=None):
    global pub, timer
    rclpy.init(args=args)
    node = Node("courier")
    pub = node.create_publisher(String, "parcels", 10)
    timer = node.create_timer(0.25, dekho)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
