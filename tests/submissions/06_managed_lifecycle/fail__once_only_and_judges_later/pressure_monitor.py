import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.create_subscription(Float64, 'pressure', self.judge, 10)
        self.limit = 0.0
        self.watching = False
        self.missed = []

    def on_configure(self, state):
        limit = self.get_parameter('limit').value
        if not limit > 0.0:
            self.get_logger().error(f'limit {limit} is not above zero')
            return TransitionCallbackReturn.FAILURE
        self.limit = limit
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.watching = True
        missed, self.missed = self.missed, []
        for message in missed:
            self.judge(message)
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.watching = False
        return super().on_deactivate(state)

    def judge(self, message):
        if not self.watching:
            self.missed.append(message)
        elif message.data > self.limit:
            self.get_logger().warning(f'{message.data} is above {self.limit}')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(PressureMonitor())


if __name__ == '__main__':
    main()
