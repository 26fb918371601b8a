import rclpy
from rclpy.executors import ExternalShutdownException
from itertools import count

from std_msgs.msg import String


def make():
    node = rclpy.create_node('talker')
    publisher = node.create_publisher(String, 'chatter', qos_profile=10)
    numbers = count(1)

    def speak():
        message = String()
        message.data = 'hello ' + str(next(numbers))
        publisher.publish(message)

    node.create_timer(0.5, speak)
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
