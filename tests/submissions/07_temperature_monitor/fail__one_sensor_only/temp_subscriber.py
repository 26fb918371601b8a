import rclpy
from rclpy.executors import ExternalShutdownException
from temp_monitor_pkg.msg import Temperature

LIMIT = 30.0


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('temperature_subscriber')

    def heard(msg):
        if msg.sensor_id != 'temp_sensor_01':
            return
        node.get_logger().info('%.2f %s' % (msg.temperature_value, msg.unit))
        if msg.unit == 'Celsius':
            value = msg.temperature_value
        elif msg.unit == 'Fahrenheit':
            value = (msg.temperature_value - 32) / 1.8
        else:
            node.get_logger().error('what is ' + msg.unit + '?')
            return
        if value > LIMIT:
            node.get_logger().warn('hot!')

    node.create_subscription(Temperature, 'temperature_topic', heard, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
