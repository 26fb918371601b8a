import rclpy
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from std_msgs.msg import String


class Node_(Node):
    def __init__(self):
        super().__init__('courier')
        events = PublisherEventCallbacks(matched=self.matched)
        self.publisher = self.create_publisher(String, 'parcels', 10, event_callbacks=events)

    def matched(self, info):
        if info.current_count == 1:
            self.publisher.publish(String(data='for you'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Node_())


if __name__ == '__main__':
    main()
