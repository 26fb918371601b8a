import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.lifecycle.managed_entity import SimpleManagedEntity
from std_msgs.msg import Float64


class Watch(SimpleManagedEntity):
    """A subscription that is deaf unless its node is active."""

    def __init__(self, node):
        super().__init__()
        self.node = node
        self.limit = None
        node.create_subscription(Float64, 'pressure', self.compare, 10)

    def on_configure(self, state):
        self.limit = self.node.get_parameter('limit').value
        if self.limit > 0:
            return TransitionCallbackReturn.SUCCESS
        self.node.get_logger().error(f'not above zero: {self.limit}')
        return TransitionCallbackReturn.FAILURE

    @SimpleManagedEntity.when_enabled
    def compare(self, message):
        if message.data > self.limit:
            self.node.get_logger().warning(f'{message.data} bar')


def main(args=None):
    rclpy.init(args=args)
    node = LifecycleNode('pressure_monitor')
    node.declare_parameter('limit', -1.0)
    node.add_managed_entity(Watch(node))
    rclpy.spin(node)


if __name__ == '__main__':
    main()
