"""Run nodes for the tests of the ros2 command; print a line when ready."""

import os
import signal

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Empty, Header, Int32, String


class Talker(Node):
    """Publishes twenty strings and headers a second; its parameter rate_hz has limits."""

    def __init__(self):
        super().__init__('talker')
        chatter = self.create_publisher(String, 'chatter', 10)
        stamped = self.create_publisher(Header, 'stamped', 10)

        def publish():
            chatter.publish(String(data='hello'))
            stamped.publish(Header(stamp=self.get_clock().now().to_msg(), frame_id='map'))

        self.create_timer(0.05, publish)
        limits = FloatingPointRange(from_value=0.5, to_value=10.0)
        words = ParameterDescriptor(description='Rate [Hz].', floating_point_range=[limits])
        self.declare_parameter('rate_hz', 2.0, words)
        self.declare_parameter('arm.names', ['left', 'right'])
        self.declare_parameter('steady', 1, ParameterDescriptor(read_only=True))
        self.add_on_set_parameters_callback(self.judge)

    def judge(self, parameters):
        """Refuse one value."""
        odd = any(one.name == 'rate_hz' and one.value == 3.0 for one in parameters)
        return SetParametersResult(successful=not odd, reason='not three' if odd else '')


class Beacon(LifecycleNode):
    """A managed node that refuses to be activated."""

    def on_activate(self, state):
        """Refuse."""
        return TransitionCallbackReturn.FAILURE


def listener(namespace):
    """Return a node that subscribes to the strings and has publishers with different QoS."""
    node = Node('listener', namespace=namespace)
    node.create_subscription(String, '/chatter', lambda message: None, 10)
    node.create_subscription(Empty, '/_hidden', lambda message: None, 10)
    node.said = node.create_publisher(Int32, 'said', 10)
    once = QoSProfile(
        depth=1,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )
    node.kept = node.create_publisher(String, 'kept', once)
    node.kept.publish(String(data='said before you came'))
    node.create_subscription(
        Int32, '/asked', lambda message: print('asked', message.data, flush=True), 10
    )
    return node


def main():
    """Spin all nodes until a signal arrives, or the test that started this program is gone."""
    # rclpy's own handler may shut down just before the wait, which raises a different exception.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    interrupted, parent = [], os.getppid()
    signal.signal(signal.SIGINT, lambda *_: interrupted.append(True))
    executor = SingleThreadedExecutor()
    nodes = [Talker(), listener('/lab'), Beacon('beacon'), Node('_shy')]
    for node in nodes:
        executor.add_node(node)
    print('ready', flush=True)
    while not interrupted and os.getppid() == parent:
        executor.spin_once(timeout_sec=0.1)


if __name__ == '__main__':
    main()
