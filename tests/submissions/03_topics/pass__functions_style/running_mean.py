import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64


def make():
    node = rclpy.create_node('running_mean')
    publisher = node.create_publisher(Float64, '/mean', 10)
    numbers = []

    def take(message):
        if message.data == message.data:
            numbers.append(message.data)
            publisher.publish(Float64(data=sum(numbers) / len(numbers)))

    node.create_subscription(Float64, '/readings', take, 10)
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
