
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


import math


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [t for t, m in zip(sent.times, sent.messages) if celsius(m) > 30.0]
    warned = [line.time_s for line in run.logged('WARN')]
    if len(due) != len(warned):
        return False
    return all(math.isclose(a, b, abs_tol=0.001) for a, b in zip(due, warned))
