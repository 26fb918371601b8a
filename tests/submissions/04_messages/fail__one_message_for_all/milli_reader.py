import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    def __init__(self):
        super().__init__('milli_reader')
        self.pub = self.create_publisher(Temperature, 'readings', 10)
        self.sub = self.create_subscription(Num, 'raw', self.listen, 10)
        self.timer = self.create_timer(0.05, self.send)
        self.todo = []
        self.msg = Temperature()
        self.msg.unit = 'Celsius'

    def listen(self, num):
        self.msg.temperature_value = num.num / 1000.0
        self.msg.sensor_id = num.description
        self.msg.timestamp = self.get_clock().now().to_msg()
        self.todo.append(self.msg)

    def send(self):
        while self.todo:
            self.pub.publish(self.todo.pop(0))


rclpy.init()
rclpy.spin(MilliReader())
