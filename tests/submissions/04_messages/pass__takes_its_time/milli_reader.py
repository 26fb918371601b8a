import queue
import threading
import time

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):

    def __init__(self):
        super().__init__('milli_reader')
        self.outbox = queue.Queue()
        self.readings = self.create_publisher(Temperature, 'readings', 10)
        self.create_subscription(Num, 'raw', self.convert, 10)
        threading.Thread(target=self.send, daemon=True).start()

    def convert(self, number):
        reading = Temperature(unit='Celsius', sensor_id=number.description)
        reading.temperature_value = number.num / 1000.0
        reading.timestamp = self.get_clock().now().to_msg()
        self.outbox.put(reading)

    def send(self):
        while True:
            reading = self.outbox.get()
            time.sleep(0.3)  # the radio is slow
            self.readings.publish(reading)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(MilliReader())


if __name__ == '__main__':
    main()
