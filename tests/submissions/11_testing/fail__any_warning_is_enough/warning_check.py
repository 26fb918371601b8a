
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def accepts(run):
    hot = any(celsius(m) > 30.0 for m in run.sent['/temperature_topic'].messages)
    return bool(run.logged('WARN')) == hot
