
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


LIMIT = 30.0


def accepts(run):
    sent = run.sent['/temperature_topic']
    warned = sorted(line.time_s for line in run.logs if line.level == 'WARN')
    due = []
    for position in range(len(sent.times)):
        if celsius(sent.messages[position]) > LIMIT:
            due.append(sent.times[position])
    return len(warned) == len(due) and all(a == b for a, b in zip(warned, due))
