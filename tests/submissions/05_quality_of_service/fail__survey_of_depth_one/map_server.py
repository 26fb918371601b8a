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


sub = node.create_subscription(String, "survey", callback, 1)

msg.data = "unknown"
pub.publish(msg)

try:
    rclpy.spin(node)
except:
    pass
