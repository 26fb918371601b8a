LIMITS = {'Celsius': 30.0, 'Fahrenheit': 86.0}


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [
        time
        for time, message in zip(sent.times, sent.messages)
        if message.temperature_value > LIMITS.get(message.unit, float('inf'))
    ]
    return due == [line.time_s for line in run.logged('WARN')]
