"""
Read and write the recording of one run, with one JSON event per line.

Recordings are stored and can be judged again.  ``docs/recording.schema.json`` describes the
header, the events and their fields.  The first line is the header.  The probe's events follow in
the order of observation, without messages and log lines that arrive after the last step, and
without events after the end of the program.  In the last event, ``process``, the grader records
how the program ended.  The events of a second start follow in the same way.  Printed text can
*explain* a verdict; it is never evidence.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
import json
from pathlib import Path
from typing import Any
import zlib

from autograder.errors import RecordingInvalid
from autograder.files import write_atomically

SECOND = 1_000_000_000

FORMAT = 'ros2-course-recording'
VERSION = 3
Event = Mapping[str, Any]
PLUMBING = ('/rosout', '/parameter_events', '/clock', '/transition_event')
"""Topics that ROS itself creates for nodes."""

WARN = 30
INFO = 20
ERROR = 40
LEVELS = {10: 'DEBUG', INFO: 'INFO', WARN: 'WARN', ERROR: 'ERROR', 50: 'FATAL'}
"""Names of log levels by their numbers (rcl_interfaces/msg/Log)."""


@dataclass(frozen=True)
class Recording:
    """
    The immutable recording of one run.

    :param header: first line of the file
    :param again: the recording of the second start, if the scenario has one; in the file, its
        events follow an event ``again``
    """

    header: Mapping[str, Any]
    events: Sequence[Event]
    again: Recording | None = None

    @property
    def starts(self) -> tuple[Recording, ...]:
        """Return the recording of the first start, followed by that of a second one."""
        return (self, self.again) if self.again else (self,)

    def of(self, kind: str, **where: Any) -> list[Event]:
        """Return the events of one kind (docs/recording.schema.json) with these field values."""
        found = self._by_kind.get(kind, [])
        for name, value in where.items():
            found = [event for event in found if event.get(name) == value]
        return list(found)

    @cached_property
    def _by_kind(self) -> dict[str, list[Event]]:
        """Return the events by kind; cached, because checks look up events very often."""
        kinds: dict[str, list[Event]] = {}
        for event in self.events:
            kinds.setdefault(event['event'], []).append(event)
        return kinds

    def messages(self, topic: str, listener: str | None = None) -> list[Event]:
        """
        Return the messages that the probe received on a topic, in order.

        :param listener: name of a subscription that joined later; None for the subscription that
            existed from the start and matches every publisher, regardless of its QoS profile
        """
        return self.of('message', topic=topic, listener=listener)

    def phase(self, name: str) -> Recording:
        """Return the part of the run from one mark to the next; empty if there is no such mark."""
        bounds = self._bounds(name)
        return Recording(self.header, [one for at, end in bounds for one in self.events[at:end]])

    def parts(self, name: str) -> list[tuple[Recording, float]]:
        """
        Return the parts of the run in a phase, each with its duration [s].

        A part begins at a mark with this name, and ends with the next mark or the end of the run.
        """
        found = []
        for at, end in self._bounds(name):
            part = Recording(self.header, self.events[at : end + 1])
            times_ns = [one.get('clock_ns') or 0 for one in part.events]
            found.append((part, (max(times_ns) - times_ns[0]) / SECOND))
        return found

    def _bounds(self, name: str) -> list[tuple[int, int]]:
        """Return the index of each mark with a name, and that of the next mark or the end."""
        marks = [at for at, event in enumerate(self.events) if event['event'] == 'mark']
        pairs = pairwise([*marks, len(self.events)])
        return [(at, end) for at, end in pairs if self.events[at]['name'] == name]

    def answers(self, service: str) -> list[Event]:
        """Return the outcomes of all calls to a service, in order, including missing answers."""
        return [
            event
            for event in self.events
            if event['event'] in ('answer', 'no_answer') and event['service'] == service
        ]

    def logs(self, *, level: int | None = None) -> list[Event]:
        """Return the log lines, optionally of one level, such as :data:`WARN`."""
        return self.of('log') if level is None else self.of('log', level=level)

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """Return the sorted distinct full names of all nodes in the run."""
        return tuple(sorted({name for graph in self.of('graph') for name in graph['nodes']}))

    def endpoints(self, kind: str, topic: str | None = None) -> list[Event]:
        """
        Return the distinct endpoints seen in any graph of the run.

        :param kind: ``'publisher'``, ``'subscription'`` or ``'service'``
        :param topic: full name, or None for all topics that ROS itself does not create; services
            that it creates are not recorded
        """
        seen: dict[str, Event] = {}
        for graph in self.of('graph'):
            for end in graph['endpoints']:
                hidden = end['topic'].endswith(PLUMBING)
                wanted = not hidden if topic is None else end['topic'] == topic
                if end['kind'] == kind and wanted:
                    seen[json.dumps(end, sort_keys=True)] = end
        return list(seen.values())

    @cached_property
    def end_reason(self) -> str:
        """Return why the scenario ended; ``'complete'`` if all steps were executed."""
        ends = self.of('end')
        return str(ends[-1]['reason']) if ends else 'broken_off'

    @cached_property
    def process(self) -> Event:
        """Return the ``process`` event, which describes the program's end; empty if missing."""
        found = self.of('process')
        return found[-1] if found else {}

    # -- files -----------------------------------------------------------------------------

    def to_bytes(self) -> bytes:
        """Return the content of the file; its header has the number of events and their CRC-32."""
        later = ({'event': 'again'}, *self.again.events) if self.again else ()
        events = [json.dumps(event, allow_nan=False) for event in (*self.events, *later)]
        rest = ''.join(f'{line}\n' for line in events).encode()
        first = {**self.header, 'seal': _seal(len(events), rest)}
        return json.dumps(first, allow_nan=False).encode() + b'\n' + rest

    @classmethod
    def from_bytes(cls, data: bytes, where: str = 'a recording') -> Recording:
        """
        Read the output of :meth:`to_bytes`.

        :raises RecordingInvalid: if the data is not a complete recording of this version
        """
        first, _, rest = data.partition(b'\n')
        try:
            found = json.loads(first)
            # Parse all lines in one call, which is three times faster.
            events = json.loads(b'[' + b','.join(rest.splitlines()) + b']')
        except ValueError as error:
            raise RecordingInvalid(f'{where}: not readable as JSON Lines ({error}).') from error
        header = found if isinstance(found, dict) else {}
        if (header.get('format'), header.get('version')) != (FORMAT, VERSION):
            raise RecordingInvalid(
                f'{where}: expected a {FORMAT} of version {VERSION}, got '
                f'{header.get("format")!r} of version {header.get("version")!r}.',
                AGAIN,
            )
        if not all(isinstance(event, dict) and 'event' in event for event in events):
            raise RecordingInvalid(f'{where}: a line is not an event.', AGAIN)
        if header.pop('seal', None) != _seal(len(events), rest):
            raise RecordingInvalid(
                f'{where}: the checksum is wrong; the file was truncated or changed.', AGAIN
            )
        if {'event': 'again'} not in events:
            return cls(header, events)
        end = events.index({'event': 'again'})
        return cls(header, events[:end], cls(header, events[end + 1 :]))

    def save(self, path: Path) -> None:
        """Write the recording to a file, atomically even if the process is killed."""
        write_atomically(path, self.to_bytes())

    @classmethod
    def load(cls, path: Path) -> Recording:
        """
        Read a recording from a file.

        :raises RecordingInvalid: if the file is not a complete recording of this version
        """
        try:
            return cls.from_bytes(path.read_bytes(), str(path))
        except OSError as error:
            raise RecordingInvalid(f'{path}: cannot be read ({error.strerror}).') from error


AGAIN = 'Try: grade again to make a new recording.'


def _seal(count: int, events: bytes) -> dict[str, Any]:
    return {'events': count, 'crc32': f'{zlib.crc32(events):08x}'}


def header(exam: str, mode: str) -> dict[str, Any]:
    """Return the header of a new recording."""
    return {'format': FORMAT, 'version': VERSION, 'exam': exam, 'mode': mode}
