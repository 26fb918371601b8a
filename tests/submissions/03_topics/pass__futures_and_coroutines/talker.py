import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.texts = iter(f'hello {n}' for n in range(1, 1_000_000))
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.5, self.speak)

    async def speak(self):
        await self.say(next(self.texts))

    async def say(self, text):
        self.pub.publish(String(data=text))


def main(args=None):
    rclpy.init(args=args)
    talker, end = Talker(), Future()
    try:
        rclpy.spin_until_future_complete(talker, end)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
