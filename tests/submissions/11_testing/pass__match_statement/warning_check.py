def to_celsius(message):
    match message.unit:
        case 'Celsius':
            return message.temperature_value
        case 'Fahrenheit':
            return (message.temperature_value - 32) / 1.8
        case _:
            raise ValueError(message.unit)


def due_times(sent):
    for time, message in zip(sent.times, sent.messages):
        try:
            if to_celsius(message) > 30:
                yield time
        except ValueError:
            continue


def accepts(run):
    warned = tuple(line.time_s for line in run.logged('WARN'))
    return warned == tuple(due_times(run.sent['/temperature_topic']))
