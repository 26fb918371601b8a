import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.limit = self.declare_parameter('limit', -1.0).value
        self.watching = False
        self.create_subscription(Float64, 'pressure', self.on_pressure, 10)

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').value
        match self.limit > 0:
            case True:
                return TransitionCallbackReturn.SUCCESS
            case False:
                self.get_logger().error(f'limit={self.limit}')
                return TransitionCallbackReturn.FAILURE

    def on_activate(self, state):
        self.watching = True
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.watching = False
        return super().on_deactivate(state)

    async def on_pressure(self, msg):
        if self.watching and msg.data > self.limit:
            await self.alarm(msg.data)

    async def alarm(self, value):
        self.get_logger().warning(f'alarm: {value}')


def main():
    rclpy.init()
    rclpy.spin(PressureMonitor())


main()
