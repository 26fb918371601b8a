import rclpy
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.arrival = Future()
        events = PublisherEventCallbacks(matched=self.notice)
        self.pub = self.create_publisher(String, 'parcels', 10, event_callbacks=events)

    def notice(self, info):
        if info.current_count and not self.arrival.done():
            self.arrival.set_result(info.current_count)

    async def deliver(self):
        await self.arrival
        self.pub.publish(String(data='for you'))


def main(args=None):
    rclpy.init(args=args)
    courier = Courier()
    executor = SingleThreadedExecutor()
    executor.add_node(courier)
    executor.create_task(courier.deliver)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
