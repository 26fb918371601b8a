
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


def check(run):
    sent = run.sent['/temperature_topic']
    warned = [line.time_s for line in run.logged('WARN')]
    for time, message in zip(sent.times, sent.messages):
        assert warned.count(time) == int(celsius(message) > 30.0), f'at {time} s'
    assert all(time in sent.times for time in warned)


def accepts(run):
    try:
        check(run)
    except AssertionError:
        return False
    return True
