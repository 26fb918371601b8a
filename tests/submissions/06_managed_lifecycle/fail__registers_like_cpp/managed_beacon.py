import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String

rclpy.init()
node = LifecycleNode('beacon')
publisher = timer = None


def configure(state):
    global publisher, timer
    publisher = node.create_lifecycle_publisher(String, 'beacon_signal', 10)
    timer = node.create_timer(1.0, flash)
    return TransitionCallbackReturn.SUCCESS


def cleanup(state):
    node.destroy_timer(timer)
    node.destroy_lifecycle_publisher(publisher)
    return TransitionCallbackReturn.SUCCESS


def flash():
    publisher.publish(String(data='here'))


node.register_on_configure(configure)
node.register_on_cleanup(cleanup)


def main():
    rclpy.spin(node)


if __name__ == '__main__':
    main()
