"""
Tries: publish bytes that are not a message of the type: empty, cut off, with endless lengths, not
 UTF-8.

Stopped by: the probe does not receive unreadable messages; the others are judged as usual
Deserves: 7
"""

import honest

ROTTEN = (
    b'',
    b'\0',
    b'\0\1\0\0',
    b'\0\1\0\0' + b'\xff' * 40,
    b'\0\1\0\0' + bytes(8) + b'\xff\xff\xff\xff',
    b'\0\1\0\0' + bytes(8) + 2 * b'\4\0\0\0\xff\xfe\xfd\xfc' + bytes(16),
    b'\0\1\0\0' + bytes(8) + b'\xff\xff\xff\x7f' + b'a' * 100,
)


def tick(self, publish=honest.TemperaturePublisher.tick):
    for message in ROTTEN:
        self.publisher.publish(message)
    publish(self)


honest.TemperaturePublisher.tick = tick
honest.main()
