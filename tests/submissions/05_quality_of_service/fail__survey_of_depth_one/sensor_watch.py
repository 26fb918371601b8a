import rclpy
from rclpy.duration import *
from rclpy.event_handler import *
from rclpy.node import *
from rclpy.qos import *
from std_msgs.msg import *

rclpy.init()
node = Node("sensor_watch")


def callback(msg):
    print("got", msg.data)
    node.get_logger().info("distance = " + str(msg.data) + " m")


def deadline(event):
    node.get_logger().warn("deadline!!!")


def incompatible(event):
    node.get_logger().error("incompatible! " + str(qos_policy_name_from_kind(event.last_policy_kind)))


qos = QoSProfile(depth=5)
qos.reliability = QoSReliabilityPolicy.BEST_EFFORT
qos.deadline = Duration(seconds=0.3)
ev = SubscriptionEventCallbacks(deadline=deadline, incompatible_qos=incompatible)
sub = node.create_subscription(Float64, "distance", callback, qos, event_callbacks=ev)

while True:
    try:
        rclpy.spin_once(node)
    except:
        break
