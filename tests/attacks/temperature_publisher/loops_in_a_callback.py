"""
Tries: compute for ever in a callback.

Stopped by: a node that does not answer ends the run; limits of processor time
Deserves: 5 at most
"""

import honest


def tick(self):
    while True:
        pass


honest.TemperaturePublisher.tick = tick
honest.main()
