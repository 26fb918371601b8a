"""
Tries: send strings that compare equal to everything.

Stopped by: only bytes cross the wire; the judge compares plain values of its own
Deserves: 13
"""

import honest


class Chameleon(str):
    def __eq__(self, other):
        return True

    def __ne__(self, other):
        return False

    def __hash__(self):
        return hash('Celsius')


sent = honest.TemperaturePublisher.reading


def reading(self):
    message = sent(self)
    message.unit = Chameleon('Kelvin')
    message.sensor_id = Chameleon('nobody')
    return message


honest.TemperaturePublisher.reading = reading
honest.main()
