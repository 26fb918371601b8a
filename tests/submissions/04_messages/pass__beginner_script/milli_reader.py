import rclpy
from rclpy.node import *
from temp_monitor_pkg.msg import *

rclpy.init()
node = Node("milli_reader")
pub = node.create_publisher(Temperature, "readings", 10)


def callback(msg):
    global t
    print("got", msg.num)
    t = Temperature()
    t.temperature_value = msg.num/1000
    t.unit = "Celsius"
    t.sensor_id = msg.description
    t.timestamp = node.get_clock().now().to_msg()
    pub.publish(t)


sub = node.create_subscription(Num, "raw", callback, 10)
try:
    rclpy.spin(node)
except:
    pass
