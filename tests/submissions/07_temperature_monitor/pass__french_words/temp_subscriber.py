"""Surveillant de température."""

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

SEUIL = 30.0


class UnitéInconnue(Exception):
    pass


def en_celsius(valeur, unité):
    if unité == 'Fahrenheit':
        return (valeur - 32.0) / 1.8
    if unité != 'Celsius':
        raise UnitéInconnue(unité)
    return valeur


class Surveillant(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.journal = self.get_logger().get_child('surveillance')
        self.create_subscription(Temperature, 'temperature_topic', self.juger, 10)

    def juger(self, mesure):
        self.journal.info('reçu : {:.2f} {}'.format(mesure.temperature_value, mesure.unit))
        try:
            trop_chaud = en_celsius(mesure.temperature_value, mesure.unit) > SEUIL
        except UnitéInconnue as unité:
            self.journal.error(f'unité inconnue : {unité}')
            return
        if trop_chaud:
            self.journal.warning('trop chaud !')


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Surveillant())
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
