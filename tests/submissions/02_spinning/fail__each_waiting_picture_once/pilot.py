import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):

    def __init__(self):
        super().__init__('pilot')
        self.last = {}
        self.publisher_ = self.create_publisher(Twist, 'cmd_vel', 10)
        self.speed_sub = self.create_subscription(Float64, 'speed', self.speed_callback, 10)
        self.turn_sub = self.create_subscription(Float64, 'turn', self.turn_callback, 10)
        self.timer = self.create_timer(0.5, self.timer_callback)

    def now_s(self):
        return self.get_clock().now().nanoseconds / 1e9

    def speed_callback(self, msg):
        self.last['speed'] = (msg.data, self.now_s())

    def turn_callback(self, msg):
        self.last['turn'] = (msg.data, self.now_s())

    def timer_callback(self):
        if len(self.last) < 2:
            return
        speed, speed_time = self.last['speed']
        turn, turn_time = self.last['turn']
        msg = Twist()
        if self.now_s() - speed_time > 2.0 or self.now_s() - turn_time > 2.0:
            self.get_logger().warning('An input is old, I stop')
        else:
            msg.linear.x = speed
            msg.angular.z = turn
        self.publisher_.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    pilot = Pilot()
    rclpy.spin(pilot)
    pilot.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
