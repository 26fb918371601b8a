import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


class MapServer(Node):
    def __init__(self):
        super().__init__('map_server')
        self.map = 'unknown'
        self.create_subscription(String, 'survey', self.on_survey, 10)
        self.pub = self.create_publisher(
            String,
            'map',
            QoSProfile(
                reliability=ReliabilityPolicy.RELIABLE,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
                history=HistoryPolicy.KEEP_LAST,
                depth=1,
            ),
        )
        self.send()

    def send(self):
        msg = String()
        msg.data = self.map
        self.pub.publish(msg)

    async def on_survey(self, msg):
        self.map = msg.data
        self.send()


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(MapServer())
    try:
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.5)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


main()
