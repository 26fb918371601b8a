def celsius(message):
    value = message.temperature_value
    return (value - 32.0) / 1.8 if message.unit == 'Fahrenheit' else value


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [time for time, message in zip(sent.times, sent.messages) if celsius(message) > 30.0]
    return [line.time_s for line in run.logged('WARN')] == due
