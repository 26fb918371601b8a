def is_hot(fields):
    value = float(fields['temperature_value'])
    if fields['unit'] == 'Fahrenheit':
        value = (value - 32.0) * 5.0 / 9.0
    elif fields['unit'] != 'Celsius':
        return False
    return value > 30.0


def accepts(run):
    sent = run.sent['/temperature_topic']
    due = {time for time, fields in zip(sent.times, sent.data) if is_hot(fields)}
    warned = [line.time_s for line in run.logged('WARN')]
    return len(warned) == len(due) and set(warned) == due
