
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


due = lambda sent: [t for t, m in zip(sent.times, sent.messages) if celsius(m) > 30.0]
warned = lambda run: [line.time_s for line in run.logged('WARN')]
accepts = lambda run: warned(run) == due(run.sent['/temperature_topic'])
