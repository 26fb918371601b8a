
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


from collections import Counter


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = Counter(t for t, m in zip(sent.times, sent.messages) if celsius(m) > 30.0)
    return Counter(line.time_s for line in run.logged('WARN')) == due
