import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn, State, Node as LNode
from std_msgs.msg import String, Float64

class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.create_subscription(Float64, 'pressure', self.judge, 10)
        self.limit = 0.0
        self.watching = False
    def on_configure(self, state):
        limit = self.get_parameter('limit').value
        if not limit > 0:
            self.get_logger().error(f'bad limit {limit}')
            return TransitionCallbackReturn.FAILURE
        self.limit = limit
        return super().on_configure(state)
    def on_activate(self, state):
        self.limit = self.get_parameter('limit').value
        self.watching = True
        return super().on_activate(state)
    def on_deactivate(self, state):
        self.watching = False
        return super().on_deactivate(state)
    def judge(self, message):
        if self.watching and message.data > self.limit:
            self.get_logger().warning(f'{message.data}')

def main(args=None):
    rclpy.init(args=args)
    node = PressureMonitor()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
