import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TempSubscriber(Node):

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.subscription = self.create_subscription(Temperature, 'temperature_topic', self.listener_callback, 10)
        self.subscription  # prevent unused variable warning

    def listener_callback(self, msg):
        self.get_logger().info('I heard: "%s"' % msg.temperature_value)
        tempIsKnown = True
        if msg.unit == "Celsius":
            tempInCelsius = msg.temperature_value
        else:
            if msg.unit == "Fahrenheit":
                tempInCelsius = (msg.temperature_value - 32) * (5 / 9)
            else:
                tempIsKnown = False
                self.get_logger().error("unknown unit: " + msg.unit)
        if tempIsKnown == True:
            if tempInCelsius > 30:
                self.get_logger().warn("WARNING! It is too hot: " + str(tempInCelsius))
            else:
                print("temperature is fine")


def main(args=None):
    rclpy.init(args=args)

    minimal_subscriber = TempSubscriber()

    rclpy.spin(minimal_subscriber)

    minimal_subscriber.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
