import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.sub = self.create_subscription(Float64, 'pressure', self.cb, 10)
        self.on = False
        self.limit = None

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').value
        if not self.limit > 0.0:
            self.get_logger().error('bad limit: ' + str(self.limit))
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.on = True
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.on = False
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self.destroy_subscription(self.sub)
        return TransitionCallbackReturn.SUCCESS

    def cb(self, msg):
        if self.on and msg.data > self.limit:
            self.get_logger().warn('pressure ' + str(msg.data))


rclpy.init()
rclpy.spin(PressureMonitor())
