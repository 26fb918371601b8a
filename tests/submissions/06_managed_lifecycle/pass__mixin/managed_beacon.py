import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class OwnsThings:
    """Destroys on cleanup what was created since configure."""

    def on_configure(self, state):
        self.things = []
        self.setup()
        return super().on_configure(state)

    def on_cleanup(self, state):
        while self.things:
            destroy, thing = self.things.pop()
            destroy(thing)
        return super().on_cleanup(state)


class Beacon(OwnsThings, LifecycleNode):
    def setup(self):
        signal = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        timer = self.create_timer(1.0, lambda: signal.publish(String(data='.')))
        self.things.append((self.destroy_lifecycle_publisher, signal))
        self.things.append((self.destroy_timer, timer))


def main(args=None):
    rclpy.init(args=args)
    node = Beacon('beacon')
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
