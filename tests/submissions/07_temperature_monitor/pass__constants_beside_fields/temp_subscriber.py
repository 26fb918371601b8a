import functools

import rclpy
from temp_monitor_pkg.msg import Temperature

to_celsius = {
    'Celsius': lambda value: value,
    'Fahrenheit': lambda value: (value - 32.0) * 5.0 / 9.0,
}


def judge(log, limit, message):
    log.info(f'{message.temperature_value:.2f}')
    convert = to_celsius.get(message.unit)
    if convert is None:
        return log.error(f'no such unit: {message.unit}')
    return convert(message.temperature_value) > limit and log.warning('hot')


def main():
    rclpy.init()
    node = rclpy.create_node('temperature_subscriber')
    callback = functools.partial(judge, node.get_logger(), 30.0)
    node.create_subscription(Temperature, 'temperature_topic', callback, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
