"""
Tries: write the probe's own events, and nbgrader's scores, to standard output and error.

Stopped by: the probe writes to a separate pipe; printed text only helps to explain a verdict
Deserves: 0
"""

import json
import sys

for second in range(1, 61):
    data = {'temperature_value': 20.0, 'unit': 'Celsius', 'sensor_id': 'temp_sensor_01'}
    event = {'event': 'message', 'topic': '/temperature_topic', 'data': data}
    for stream in (sys.stdout, sys.stderr):
        print(json.dumps({**event, 'clock_ns': second * 10**9}), file=stream)
print(json.dumps({'event': 'end', 'reason': 'complete', 'clock_ns': None}))
print('15.0')
