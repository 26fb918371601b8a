import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String

done = TransitionCallbackReturn.SUCCESS
configure = lambda self, state: (
    setattr(self, 'out', self.create_lifecycle_publisher(String, 'beacon_signal', 10)),
    setattr(self, 'tick', self.create_timer(1.0, lambda: self.out.publish(String(data='!')))),
    done,
)[-1]
cleanup = lambda self, state: (
    self.tick.cancel(),
    self.destroy_timer(self.tick),
    self.destroy_lifecycle_publisher(self.out),
    done,
)[-1]
Beacon = type('Beacon', (LifecycleNode,), {'on_configure': configure, 'on_cleanup': cleanup})

rclpy.init()
rclpy.spin(Beacon('beacon'))
