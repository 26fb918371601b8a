"""
The recording of one run: what the probe received, as one JSON event per line.

Recordings are stored and can be judged again.  ``docs/recording.schema.json`` describes every line
and its fields.  The first line, the header, has digests of files, scenario and environment, and a
checksum that shows whether the file was cut off.  Its other facts (time, versions, ``repeated``)
are for people, never for a verdict.  Then come events of the probe, in order of observation:

* of the graph: ``seen`` (first nodes), ``graph``, ``asked`` (after the steps: is a node spun?),
  ``imitated`` (a node has the name of the probe's own)
* what arrived: ``message``, ``log``, ``answer``, ``no_answer``
* what the probe did: ``input``, ``not_connected`` (nobody listened where an input was due),
  ``joined``, ``offered``, ``left``, ``mark`` (a phase begins), ``end`` (complete, or why not)

and ``process``, in which the grader records how the program ended.  Printed text can *explain* a
verdict; it is never evidence.  The recording has no messages and log entries from the time in
which nodes are asked, and nothing from after the end of the program.

``clock_ns`` is virtual time since the program started, exact to the nanosecond; null where a limit
ended the run.  Non-finite floats are the strings 'nan', 'inf' and '-inf'.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
import json
from pathlib import Path
from typing import Any
import zlib

from autograder.errors import RecordingInvalid
from autograder.files import keep

FORMAT = 'ros2-course-recording'
VERSION = 2
Event = Mapping[str, Any]
PLUMBING = ('/rosout', '/parameter_events', '/clock', '/transition_event')
"""Topics that come with every node, regardless of its code."""

WARN = 30
INFO = 20
ERROR = 40
LEVELS = {10: 'DEBUG', INFO: 'INFO', WARN: 'WARN', ERROR: 'ERROR', 50: 'FATAL'}
"""Levels of log lines by their number (rcl_interfaces/msg/Log)."""


@dataclass(frozen=True)
class Recording:
    """
    One run, read-only.

    :param header: first line of the file
    :param events: the other lines, in order
    """

    header: Mapping[str, Any]
    events: Sequence[Event]

    def of(self, kind: str, **where: Any) -> list[Event]:
        """
        Return the events of one kind whose facts equal ``where``.

        :param kind: an event name, see the module's documentation
        """
        found = self._by_kind.get(kind, [])
        for name, value in where.items():
            found = [event for event in found if event.get(name) == value]
        return list(found)

    @cached_property
    def _by_kind(self) -> dict[str, list[Event]]:
        """Return the events by their kind, because checks ask for them a hundred times."""
        kinds: dict[str, list[Event]] = {}
        for event in self.events:
            kinds.setdefault(event['event'], []).append(event)
        return kinds

    def messages(self, topic: str, listener: str | None = None) -> list[Event]:
        """
        Return what was received on a topic, in order.

        :param listener: the subscription that joined under this name; None for the one that
            existed from the beginning and receives from every publisher, whatever its quality of
            service
        """
        return self.of('message', topic=topic, listener=listener)

    def phase(self, name: str) -> Recording:
        """
        Return the part of the run from one mark to the next; empty if it was never reached.

        :param name: see :class:`autograder.exam.scenario.Mark`
        """
        inside, events = False, []
        for event in self.events:
            if event['event'] == 'mark':
                inside = event['name'] == name
            if inside:
                events.append(event)
        return Recording(self.header, events)

    def answers(self, service: str) -> list[Event]:
        """
        Return the outcomes of the calls of a service, in order, including missing answers.

        :param service: full name, such as ``/thermometer/get_state``
        """
        return [
            event
            for event in self.events
            if event['event'] in ('answer', 'no_answer') and event['service'] == service
        ]

    def logs(self, *, level: int | None = None, after_input: int | None = None) -> list[Event]:
        """
        Return log entries, optionally of one level and after one input.

        :param level: 10 DEBUG, 20 INFO, 30 WARN, 40 ERROR, 50 FATAL (rcl_interfaces/msg/Log)
        """
        return [
            entry
            for entry in self.of('log')
            if (level is None or entry['level'] == level)
            and (after_input is None or entry['after_input'] == after_input)
        ]

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """Return the full names of all nodes that were seen, sorted, without repeats."""
        return tuple(sorted({name for graph in self.of('graph') for name in graph['nodes']}))

    def endpoints(self, kind: str, topic: str | None = None) -> list[Event]:
        """
        Return the distinct endpoints seen in any graph of the run.

        :param kind: ``'publisher'`` or ``'subscription'``
        :param topic: full topic name, or None for all except the topics that every node has
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
        """Return why the scenario ended; ``'complete'`` if it ran to its end."""
        ends = self.of('end')
        return str(ends[-1]['reason']) if ends else 'broken_off'

    @cached_property
    def process(self) -> Event:
        """Return how the student's process ended; empty if unknown."""
        found = self.of('process')
        return found[-1] if found else {}

    # -- files -----------------------------------------------------------------------------

    def lines(self) -> Iterator[str]:
        """Return the file's lines, without its checksum."""
        for line in (self.header, *self.events):
            yield json.dumps(line, allow_nan=False)

    def to_bytes(self) -> bytes:
        """Return the file, in which the header has the number of events and their CRC-32."""
        _, *events = self.lines()
        rest = ''.join(f'{line}\n' for line in events).encode()
        first = {**self.header, 'seal': _seal(len(events), rest)}
        return json.dumps(first, allow_nan=False).encode() + b'\n' + rest

    @classmethod
    def from_bytes(cls, data: bytes, where: str = 'a recording') -> Recording:
        """
        Read what :meth:`to_bytes` wrote.

        :param where: how to name it in messages
        :raises RecordingInvalid: if it is not a complete recording of this version
        """
        first, _, rest = data.partition(b'\n')
        try:
            found = json.loads(first)
            # One call for all lines is three times faster; the seal counts them.
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
                f'{where}: the checksum is wrong; the file was cut off or changed.', AGAIN
            )
        return cls(header, events)

    def save(self, path: Path) -> None:
        """Write the file atomically, even if a process is killed or the power fails."""
        keep(path, self.to_bytes())

    @classmethod
    def load(cls, path: Path) -> Recording:
        """
        Read a file.

        :raises RecordingInvalid: if it is not a complete recording of this version
        """
        try:
            return cls.from_bytes(path.read_bytes(), str(path))
        except OSError as error:
            raise RecordingInvalid(f'{path}: cannot be read ({error.strerror}).') from error


AGAIN = 'Try: grade again, which records it again.'


def _seal(count: int, events: bytes) -> dict[str, Any]:
    return {'events': count, 'crc32': f'{zlib.crc32(events):08x}'}


def header(exam: str, mode: str) -> dict[str, Any]:
    """Return the first line of a new recording."""
    return {'format': FORMAT, 'version': VERSION, 'exam': exam, 'mode': mode}
