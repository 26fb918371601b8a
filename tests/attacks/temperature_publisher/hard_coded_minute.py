"""
Tries: send a whole minute of prepared readings at once, stamped 1 s to 60 s.

Stopped by: the ROS clock, which the probe moves and the program cannot foresee
Deserves: 9
"""

from builtin_interfaces.msg import Time
import rclpy

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = rclpy.create_node('temperature_publisher')
publisher = node.create_publisher(Temperature, 'temperature_topic', 10)


def everything():
    timer.cancel()
    for second in range(1, 61):
        publisher.publish(
            Temperature(
                temperature_value=20.0 + second / 10,
                unit='Celsius',
                sensor_id='temp_sensor_01',
                timestamp=Time(sec=second),
            )
        )


timer = node.create_timer(4.0, everything)
rclpy.spin(node)
