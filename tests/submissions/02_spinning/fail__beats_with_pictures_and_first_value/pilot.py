import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64

rclpy.init()
node = Node('pilot')
pub = node.create_publisher(Twist, 'cmd_vel', 10)
speed = None
turn = None
speed_ticks = 0
turn_ticks = 0

def speed_cb(msg):
    global speed, speed_ticks
    if speed is None:
        speed = msg.data
    speed_ticks = 0

def turn_cb(msg):
    global turn, turn_ticks
    if turn is None:
        turn = msg.data
    turn_ticks = 0

def timer_cb():
    global speed_ticks, turn_ticks
    speed_ticks = speed_ticks + 1
    turn_ticks = turn_ticks + 1
    if speed is not None and turn is not None:
        t = Twist()
        # four ticks are two seconds
        if speed_ticks <= 4 and turn_ticks <= 4:
            t.linear.x = speed
            t.angular.z = turn
        else:
            t.linear.x = 0.0
            t.angular.z = 0.0
        pub.publish(t)

node.create_subscription(Float64, 'speed', speed_cb, 10)
node.create_subscription(Float64, 'turn', turn_cb, 10)
node.create_timer(0.5, timer_cb)
rclpy.spin(node)
