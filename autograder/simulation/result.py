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
    published, process = about['published'], recording.process
    return Simulation(
        about['exam'],
        {
            topic: _record(topic, name, events.messages(topic), seconds)
            for topic, name in published.items()
        },
        {
            topic: _record(
                f'{topic} (late)', published[topic], events.messages(topic, listener), seconds
            )
            for topic, listener in ((one['topic'], one['listener']) for one in events.of('joined'))
        },
        {
            topic: _record(f'{topic} (input)', name, events.of('input', topic=topic), seconds)
            for topic, name in about['sent'].items()
        },
        tuple(map(_log, events.of('log'))),
        'complete' if complete else recording.end_reason,
        seconds,
        None if complete else process['exit'],
        process['stdout'] + process['stderr'],
        about['mode'],
    )


def _record(label: str, name: str, events: Sequence[Event], seconds: float) -> TopicRecord:
    times = tuple(one['clock_ns'] / 1e9 for one in events)
    return TopicRecord(label, name, times, tuple(one.get('data') for one in events), seconds)


def _log(event: Event) -> LogRecord:
    level = LEVELS.get(event['level'], str(event['level']))
    return LogRecord(event['clock_ns'] / 1e9, level, event['name'], event['text'])
