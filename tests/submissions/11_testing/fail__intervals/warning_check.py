
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def accepts(run):
    sent = run.sent['/temperature_topic']
    ends = [*sent.times[1:], float('inf')]
    for begin, end, message in zip(sent.times, ends, sent.messages):
        own = [line for line in run.logged('WARN') if begin <= line.time_s < end]
        at_once = all(line.time_s - begin < 0.5 for line in own)
        if len(own) != int(celsius(message) > 30.0) or not at_once:
            return False
    return not [line for line in run.logged('WARN') if line.time_s < sent.times[0]]
