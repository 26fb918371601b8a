import rclpy, math
from rclpy.node import Node
from rclpy.executors import MultiThreadedExecutor
from rclpy.callback_groups import ReentrantCallbackGroup
from temp_monitor_pkg.msg import Temperature
class S(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.sub = self.create_subscription(Temperature, 'temperature_topic', self.cb, 10)
    def cb(self, msg):
        log = self.get_logger()
        v = msg.temperature_value
        if msg.unit == 'Fahrenheit':
            v = (v - 32) * 5 / 9
        elif msg.unit != 'Celsius':
            log.error(f'unknown unit {msg.unit!r}')
            return
        print(f'Temperature {v:.1f}')
        if v > 30.0:
            log.warning(f'Hot! {v:.1f}')

def main():
    rclpy.init(); rclpy.spin(S())
