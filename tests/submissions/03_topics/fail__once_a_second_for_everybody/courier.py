import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.event_handler import PublisherEventCallbacks
from std_msgs.msg import String


def make():
    node = rclpy.create_node('courier')

    def matched(event):
        if event.current_count_change > 0:
            publisher.publish(String(data='for you'))

    events = PublisherEventCallbacks(matched=matched)
    publisher = node.create_publisher(String, 'parcels', 10, event_callbacks=events)
    return node


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(make())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
