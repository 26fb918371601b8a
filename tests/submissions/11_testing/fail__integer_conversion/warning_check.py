def accepts(run):
    sent = run.sent['/temperature_topic']
    due = [time for time, message in zip(sent.times, sent.messages) if (
                message.temperature_value
                if message.unit == 'Celsius'
                else (message.temperature_value - 32) // 1.8
            )
            > 30.0]
    return [line.time_s for line in run.logged('WARN')] == due
