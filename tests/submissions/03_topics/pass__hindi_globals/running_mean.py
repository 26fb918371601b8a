import math
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

jod = 0.0
kitne = 0
pub = None


def naya(msg):
    # NaN को छोड़ दो
    global jod, kitne
    if math.isnan(msg.data) == True:
        return
    else:
        jod = jod + msg.data
        kitne = kitne + 1
        ausat = Float64()
        ausat.data = jod / kitne
        pub.publish(ausat)


def main(args=None):
    global pub
    rclpy.init(args=args)
    node = Node("running_mean")
    pub = node.create_publisher(Float64, "mean", 10)
    node.create_subscription(Float64, "readings", naya, 10)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
