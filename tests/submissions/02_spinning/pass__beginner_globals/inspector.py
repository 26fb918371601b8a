import threading
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty
from std_msgs.msg import String

def inspect(picture):
    time.sleep(1.2)
    return picture.upper()

rclpy.init()
node = Node('inspector')
pub = node.create_publisher(String, 'results', 10)
pub2 = node.create_publisher(Empty, 'alive', 10)

def heart():
    while True:
        pub2.publish(Empty())
        time.sleep(0.5)

def cb(msg):
    res = inspect(msg.data)
    m = String()
    m.data = res
    pub.publish(m)

sub = node.create_subscription(String, 'pictures', cb, 10)
t = threading.Thread(target=heart)
t.daemon = True
t.start()
rclpy.spin(node)
