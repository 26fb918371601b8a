from rclpy.executors import SingleThreadedExecutor
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String

OK = TransitionCallbackReturn.SUCCESS


def make_beacon():
    things = {}

    class Beacon(LifecycleNode):
        def on_configure(self, state):
            things['out'] = self.create_lifecycle_publisher(String, 'beacon_signal', 5)
            return OK

        def on_activate(self, state):
            if not things['out'].get_subscription_count():
                return TransitionCallbackReturn.FAILURE
            count = iter(range(10**6))
            things['timer'] = self.create_timer(
                1, lambda: things['out'].publish(String(data=f'flash {next(count)}'))
            )
            return super().on_activate(state)

        def on_deactivate(self, state):
            self.destroy_timer(things.pop('timer'))
            return super().on_deactivate(state)

        def on_cleanup(self, state):
            self.destroy_lifecycle_publisher(things.pop('out'))
            return OK

    return Beacon('beacon')


def main():
    rclpy.init()
    node = make_beacon()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while rclpy.ok():
        executor.spin_once(timeout_sec=0.1)


if __name__ == '__main__':
    main()
