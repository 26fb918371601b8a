import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitorNode(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.mySubscription = self.create_subscription(Float64, 'pressure', self.listener_callback, 10)
        self.mySubscription  # prevent unused variable warning
        self.isActive = False

    def on_configure(self, previousState):
        self.myLimit = self.get_parameter('limit').get_parameter_value().double_value
        print('limit is', self.myLimit)
        if self.myLimit > 0.0:
            self.get_logger().info('limit ok: ' + str(self.myLimit))
            return TransitionCallbackReturn.SUCCESS
        else:
            self.get_logger().error('limit not ok: ' + str(self.myLimit))
            return TransitionCallbackReturn.FAILURE

    def on_activate(self, previousState):
        self.isActive = True
        return super().on_activate(previousState)

    def on_deactivate(self, previousState):
        self.isActive = False
        return super().on_deactivate(previousState)

    def on_cleanup(self, previousState):
        self.myLimit = None
        return TransitionCallbackReturn.SUCCESS

    def listener_callback(self, msg):
        print('got', msg.data)
        if self.isActive == True:
            if msg.data > self.myLimit:
                self.get_logger().warn('TOO HIGH: "%s"' % msg.data)


def main(args=None):
    rclpy.init(args=args)
    myNode = PressureMonitorNode()
    while rclpy.ok():
        rclpy.spin_once(myNode, timeout_sec=0.1)


if __name__ == '__main__':
    main()
