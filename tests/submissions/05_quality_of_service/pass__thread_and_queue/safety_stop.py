import queue
import threading

from geometry_msgs.msg import Twist
import rclpy

rclpy.init()
node = rclpy.create_node('safety_stop')
out = node.create_publisher(Twist, 'cmd_vel', 10)
inbox = queue.SimpleQueue()
node.create_subscription(Twist, 'cmd_vel_raw', inbox.put, 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
patience = None
while True:
    try:
        command = inbox.get(timeout=patience)
    except queue.Empty:
        out.publish(Twist())
        patience = None
        continue
    command.linear.x = max(-0.5, min(command.linear.x, 0.5))
    out.publish(command)
    patience = 0.5
