
def celsius(message):
    if message.unit == 'Celsius':
        return message.temperature_value
    if message.unit == 'Fahrenheit':
        return (message.temperature_value - 32.0) / 1.8
    return float('nan')


class Judge:
    def __init__(self, run):
        self.sent = run.sent['/temperature_topic']
        self.warned = [line.time_s for line in run.logged('warn')]
        self.complaints = []

    def look(self):
        for time, message in zip(self.sent.times, self.sent.messages):
            due = celsius(message) > 30.0
            if due and time not in self.warned:
                self.complaints.append(f'no warning at {time} s')
            if self.warned.count(time) > due:
                self.complaints.append(f'too many warnings at {time} s')
        extra = [time for time in self.warned if time not in self.sent.times]
        self.complaints += [f'a warning at {time} s without a reading' for time in extra]
        return self


def accepts(run):
    judge = Judge(run).look()
    print(*judge.complaints, sep='\n')
    return not judge.complaints
