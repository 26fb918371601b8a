"""Plot a numeric field of a topic against time, redrawn in its cell while other cells run."""

from collections.abc import Iterable, Mapping
import math

from autograder.simulated import TopicRecord
from roslab.errors import RoslabError
from roslab.fields import number_getter
from roslab.introspection import listen_with_found_type
from roslab.listening import Listener
from roslab.live_picture import LivePicture
from roslab.plot_picture import Curve, curve_html, curve_text


class Plot(LivePicture):
    """
    A picture that follows a topic, or that shows one topic of a simulation.

    The arguments are those of :func:`plot`.
    """

    def __init__(
        self,
        topic: str | TopicRecord,
        field: str,
        seconds: float | None = None,
        threshold: float | None = None,
        marks: Mapping[str, Iterable[float]] | None = None,
    ) -> None:
        if seconds is None:
            seconds = topic.seconds if isinstance(topic, TopicRecord) else 20.0
        _require_numbers(seconds, threshold)
        self.field = field
        self.seconds = seconds
        self.threshold = threshold
        self.marks = {label: tuple(times) for label, times in (marks or {}).items()}
        self.listener: Listener | TopicRecord = (
            topic if isinstance(topic, TopicRecord) else listen_with_found_type(topic)
        )
        try:
            self._number = number_getter(self.listener.msg_type, field)
        except RoslabError:
            self.listener.stop()
            raise
        # A plot of a simulation must not end the live plot of a topic with the same name.
        super().__init__(('plot', self.topic, field, isinstance(topic, TopicRecord)))

    @property
    def topic(self) -> str:
        """Full name of the topic."""
        return self.listener.topic

    @property
    def values(self) -> list[float]:
        """All values of the field so far, oldest first."""
        found = (self._number(message) for message in self.listener.messages)
        return [value for value in found if value is not None]

    def wait(self, count: int = 1, timeout: float = 10.0) -> list[float]:
        """
        Wait until a number of messages have arrived and the picture shows them.

        :param count: number of messages since the plot began
        :param timeout: how long to wait [s]
        :returns: all values so far
        :raises TimeoutError: with possible reasons
        """
        try:
            self.listener.wait(count, timeout)
        finally:
            self._resume_updates()
            self._paint()
        return self.values

    def _newest(self) -> tuple[int, float]:
        times = self.listener.times
        return len(times), times[-1] if times else -1.0

    def _curve(self) -> Curve:
        times, messages = self.listener.times, self.listener.messages
        begin = (times[-1] if times else 0.0) - self.seconds
        recent = [(time, self._number(m)) for time, m in zip(times, messages) if time >= begin]
        return Curve(
            f'{self.topic} {self.field}',
            tuple((time, value) for time, value in recent if value is not None),
            self.seconds,
            self.threshold,
            self.marks,
        )

    def _can_change(self) -> bool:
        return self.listener.alive

    def _finish(self) -> None:
        self.listener.stop()

    def _html(self) -> str:
        return curve_html(self._curve())

    def __repr__(self) -> str:
        return curve_text(self._curve())


def _require_numbers(seconds: float, threshold: float | None) -> None:
    if not isinstance(seconds, (int, float)) or not math.isfinite(seconds) or seconds <= 0:
        raise RoslabError(f'seconds: expected a length of time, as in 20.0, got {seconds!r}.')
    if threshold is not None and not isinstance(threshold, (int, float)):
        raise RoslabError(f'threshold: expected a number, as in 30.0, got {threshold!r}.')


def plot(
    topic: str | TopicRecord,
    field: str,
    *,
    seconds: float | None = None,
    threshold: float | None = None,
    marks: Mapping[str, Iterable[float]] | None = None,
) -> Plot:
    """
    Plot a numeric field of a topic against time; the picture in this cell stays up to date.

    :param topic: name of a topic in the graph, or the messages of a simulation, as in
        ``plot(run['temperature_topic'], 'temperature_value')``
    :param field: path of the field, such as ``temperature``, ``header.stamp.sec`` or ``data[0]``
    :param seconds: length of the time axis [s]; None for 20 s, or for a whole simulation
    :param threshold: a value to draw as a horizontal line; values above it are highlighted
    :param marks: names and times of other events, as in ``timeline`` [s]
    :raises NotHereError: if the topic has no endpoint
    :raises RoslabError: if the field does not exist or is not numeric
    """
    made = Plot(topic, field, seconds, threshold, marks)
    made.begin()
    return made
