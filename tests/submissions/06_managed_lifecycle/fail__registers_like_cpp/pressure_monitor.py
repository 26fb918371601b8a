import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.lifecycle.managed_entity import SimpleManagedEntity
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.switch = SimpleManagedEntity()
        self.add_managed_entity(self.switch)
        self.declare_parameter('limit', -1.0)
        guarded = self.switch.when_enabled(self.compare)
        self.create_subscription(Float64, 'pressure', guarded, 10)

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').value
        if self.limit > 0:
            return super().on_configure(state)
        self.get_logger().error(f'not above zero: {self.limit}')
        return TransitionCallbackReturn.FAILURE

    def compare(self, message):
        if message.data > self.limit:
            self.get_logger().warning(f'{message.data} bar')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(PressureMonitor())


if __name__ == '__main__':
    main()
