
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


import math


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = []
    for time, message in zip(sent.times, sent.messages):
        value = celsius(message)
        if not math.isnan(value) and round(value) > 30:
            due.append(time)
    return [line.time_s for line in run.logged('WARN')] == due
