from enum import auto, Enum

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class State(Enum):
    WAITING = auto()
    DONE = auto()


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.state = State.WAITING
        self.door = self.create_publisher(String, 'parcels', 10)
        self.create_timer(0.1, self.step)

    def step(self):
        match self.state, self.door.get_subscription_count():
            case State.WAITING, 0:
                pass
            case State.WAITING, _:
                self.door.publish(String(data='for you'))
                self.state = State.DONE
            case State.DONE, _:
                pass


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Courier())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
