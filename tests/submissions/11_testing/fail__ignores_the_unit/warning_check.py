def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [time for time, message in zip(sent.times, sent.messages) if message.temperature_value > 30.0]
    return [line.time_s for line in run.logged('WARN')] == due
