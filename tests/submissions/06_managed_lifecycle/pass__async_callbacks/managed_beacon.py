import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self, **kwargs):
        super().__init__('beacon', **kwargs)

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.tmr = self.create_timer(1.0, self.on_timer)
        return TransitionCallbackReturn.SUCCESS

    async def on_timer(self):
        await self.send('async flash')

    async def send(self, text):
        self.pub.publish(String(data=text))

    def on_cleanup(self, state):
        self.destroy_timer(self.tmr)
        self.destroy_lifecycle_publisher(self.pub)
        return TransitionCallbackReturn.SUCCESS


def main():
    rclpy.init()
    try:
        rclpy.spin(Beacon())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


main()
