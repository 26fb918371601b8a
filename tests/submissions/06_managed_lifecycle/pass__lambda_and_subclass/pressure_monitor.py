import rclpy
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher, TransitionCallbackReturn
from std_msgs.msg import Float64

R = TransitionCallbackReturn


class PressureMonitor(LifecycleNode):
    """Uses a publisher of its own as the switch."""

    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.switch = self.create_lifecycle_publisher(Float64, 'alarm', 10)
        self.create_subscription(
            Float64, 'pressure', lambda m: self.switch.is_activated and self.judge(m.data), 10
        )

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').value
        ok = self.limit > 0
        ok or self.get_logger().error(f'{self.limit}: not a limit')
        return R.SUCCESS if ok else R.FAILURE

    def judge(self, value):
        if value > self.limit:
            self.get_logger().warning(f'{value}')
            self.switch.publish(Float64(data=value))


def main():
    rclpy.init()
    rclpy.spin(PressureMonitor())


main()
