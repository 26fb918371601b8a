import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.create_subscription(Float64, 'pressure', self.check, 10)

    def on_configure(self, state):
        limit = self.get_parameter('limit').value
        if limit > 0.0:
            self.limit = limit
            return TransitionCallbackReturn.SUCCESS
        self.get_logger().error(f'{limit=} makes no sense')
        return TransitionCallbackReturn.FAILURE

    def check(self, msg):
        _, label = self._state_machine.current_state
        if label == 'active' and msg.data > self.limit:
            self.get_logger().warning(f'{msg.data} bar!')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(PressureMonitor())
    rclpy.shutdown()


if __name__ == '__main__':
    main()
