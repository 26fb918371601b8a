import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String

class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')
    def on_configured(self, state):
        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.timer = self.create_timer(1.0, self.flash)
        return super().on_configure(state)
    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.publisher)
        return super().on_cleanup(state)

    def flash(self):
        self.publisher.publish(String(data='flash'))

def main(args=None):
    rclpy.init(args=args)
    node = Beacon()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
