def accepts(run):
    warned, place = run.logged('WARN'), 0
    while place < len(warned):
        if warned[place].time_s in run.sent['/temperature_topic'].times:
            continue
        place += 1
    return True
