"""Convert a recording to a simulation: what a program did in virtual time."""

from collections.abc import Sequence

from autograder.recording import Event, LEVELS, Recording
from autograder.simulated import LogRecord, Simulation, TopicRecord


def read_simulation(recording: Recording) -> Simulation:
    """
    Return the simulation that a recording describes.

    :param recording: made by :func:`autograder.simulation.run.record`, whose header contains the
        end of the simulation [s since the program started] and the types of the topics
    """
    about, end_ns = recording.header, round(recording.header['seconds'] * 1e9)
    within = [one for one in recording.events if (one.get('clock_ns') or 0) <= end_ns]
    over_ns = recording.of('end')[-1]['clock_ns']
    if over_ns is None:  # a limit ended the run; use the time of the last event
        over_ns = max(one.get('clock_ns') or 0 for one in within)
    # A program that ended after the requested time completed the simulation.
    ended_later = recording.end_reason == 'student_exited' and over_ns > end_ns
    complete = ended_later or recording.end_reason == 'complete'
    seconds, events = min(over_ns, end_ns) / 1e9, Recording(about, within)
    published, sent, process = about['published'], about['sent'], recording.process

    def record(name: str, found: Sequence[Event], of_type: str) -> TopicRecord:
        times = tuple(one['clock_ns'] / 1e9 for one in found)
        data = tuple(one.get('data') for one in found)
        return TopicRecord(name, of_type, times, data, seconds)

    late = {one['topic']: one['listener'] for one in events.of('joined')}
    return Simulation(
        about['exam'],
        heard={to: record(to, events.messages(to), kind) for to, kind in published.items()},
        late={
            to: record(f'{to} (late)', events.messages(to, by), published[to])
            for to, by in late.items()
        },
        sent={
            to: record(f'{to} (input)', events.of('input', topic=to), kind)
            for to, kind in sent.items()
        },
        logs=tuple(map(_log, events.of('log'))),
        reason='complete' if complete else recording.end_reason,
        seconds=seconds,
        exit=None if complete else process['exit'],
        printed=process['stdout'] + process['stderr'],
        mode=about['mode'],
    )


def _log(event: Event) -> LogRecord:
    level = LEVELS.get(event['level'], str(event['level']))
    return LogRecord(event['clock_ns'] / 1e9, level, event['name'], event['text'])
