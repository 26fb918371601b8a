import rclpy, random
from temp_monitor_pkg.msg import Temperature
def main():
    rclpy.init()
    node = rclpy.create_node('temperature_publisher')
    pub = node.create_publisher(Temperature, 'temperature_topic', 10)
    def tick():
        m = Temperature()
        m.temperature_value = float(random.randint(20, 30))
        m.unit = 'Celsius'; m.sensor_id = 'temp_sensor_01'
        m.timestamp = node.get_clock().now().to_msg()
        pub.publish(m)
        node.get_logger().info(f'sent {m.temperature_value}')
    node.create_timer(1.0, tick)
    rclpy.spin(node)
main()
