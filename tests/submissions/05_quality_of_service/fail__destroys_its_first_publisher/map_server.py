import rclpy
from rclpy.node import *
from rclpy.qos import *
from std_msgs.msg import *

rclpy.init()
node = Node("map_server")
qos = QoSProfile(depth=1)
qos.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
pub = node.create_publisher(String, "map", qos)
msg = String()


def callback(survey):
    global msg
    msg = survey
    pub.publish(msg)


sub = node.create_subscription(String, "survey", callback, 10)

first = node.create_publisher(String, "map", qos)
first.publish(String(data="unknown"))
node.destroy_publisher(first)

try:
    rclpy.spin(node)
except:
    pass
