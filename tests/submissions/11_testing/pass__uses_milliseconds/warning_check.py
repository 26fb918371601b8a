
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def accepts(run):
    sent = run.sent['/temperature_topic']
    warned = [round(line.time_s * 1000) for line in run.logged('WARN')]
    hot = [round(t * 1000) for t, m in zip(sent.times, sent.messages) if celsius(m) > 30.0]
    return warned == hot
