
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [time for time, message in zip(sent.times, sent.messages) if celsius(message) > 30.0]
    warned = [line.time_s for line in run.logged('WARN')]
    return due[:1] == warned[:1]
