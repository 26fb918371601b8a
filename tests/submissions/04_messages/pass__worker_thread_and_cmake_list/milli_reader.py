import queue
import threading

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    def __init__(self, **kw):
        super().__init__('milli_reader', **kw)
        self.todo = queue.Queue()
        self.out = self.create_publisher(Temperature, 'readings', 10)
        self.create_subscription(Num, 'raw', self.todo.put, 10)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            one = self.todo.get()
            now = self.get_clock().now().seconds_nanoseconds()
            reading = Temperature(unit='Celsius', sensor_id=one.description)
            reading.temperature_value = one.num / 1000
            reading.timestamp.sec, reading.timestamp.nanosec = now
            self.out.publish(reading)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(MilliReader())


if __name__ == '__main__':
    main()
