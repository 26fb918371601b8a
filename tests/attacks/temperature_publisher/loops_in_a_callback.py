"""
Tries: compute forever in a callback.

Stopped by: the limit of processor time
Deserves: 5 at most
Ends: cpu_limit
"""

import honest


def tick(self):
    while True:
        pass


honest.TemperaturePublisher.tick = tick
honest.main()
