"""
Find out which offered QoS satisfies which request, with real publishers and subscriptions.

``qos_table('reliability')`` creates one pair per combination, each on a separate topic.  It waits
until *every* pair has reported its outcome: matched, or refused with the event that names the
policy.  A missing event never counts as an outcome.  The table also shows the prediction of
``qos_check_compatible`` and of the documented rule.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from itertools import count, product
import os
import time
from typing import Any

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    qos_check_compatible,
    qos_policy_name_from_kind,
    QoSProfile,
    ReliabilityPolicy,
)
from std_msgs.msg import Empty

from roslab.errors import RoslabError
from roslab.interrupts import HeldInterrupts
from roslab.output import text_table

_PATIENCE_S = 10.0
"""Time limit [s], reached only on a very busy machine; a table usually takes 0.2 s."""
_tables = count(1)

Choice = Mapping[str, Any]


def _named(field: str, kind: Any, *names: str) -> dict[str, Choice]:
    return {name: {field: kind[name]} for name in names}


def _lasting(field: str) -> dict[str, Choice]:
    limits = {f'{seconds} s': {field: Duration(seconds=seconds)} for seconds in (2, 1)}
    return {'no limit': {}, **limits}


_UNDECIDED = ('SYSTEM_DEFAULT', 'BEST_AVAILABLE')
_RELIABILITY = _named('reliability', ReliabilityPolicy, 'BEST_EFFORT', 'RELIABLE')
_DURABILITY = _named('durability', DurabilityPolicy, 'VOLATILE', 'TRANSIENT_LOCAL')

CHOICES: Mapping[str, Mapping[str, Choice]] = {
    'reliability': _RELIABILITY | _named('reliability', ReliabilityPolicy, *_UNDECIDED),
    'durability': _DURABILITY | _named('durability', DurabilityPolicy, *_UNDECIDED),
    'reliability and durability': {
        f'{one}, {other}': {**_RELIABILITY[one], **_DURABILITY[other]}
        for one, other in product(_RELIABILITY, _DURABILITY)
    },
    'deadline': _lasting('deadline'),
    'liveliness': _named(
        'liveliness', LivelinessPolicy, 'AUTOMATIC', 'MANUAL_BY_TOPIC', *_UNDECIDED
    ),
    'lease': _lasting('liveliness_lease_duration'),
    'lifespan': _lasting('lifespan'),
    'depth': {
        'keep last 1': {'depth': 1},
        'keep last 10': {'depth': 10},
        'keep all': {'history': HistoryPolicy.KEEP_ALL},
    },
}
"""The values to combine on both sides, weakest first, by the name of the table."""

_SIGNS = {True: '\N{CHECK MARK}', False: '\N{BALLOT X}'}
# Transparent colours, so that text has enough contrast on light and on dark pages.
_TINTS = {True: '#43a04729', False: '#e5393529'}
_NEVER_MATTERS = ('lifespan', 'depth')


@dataclass(frozen=True)
class Cell:
    """
    The outcome for one pair of endpoints.

    :param refused_for: incompatible policies that the events of both sides name
    :param check: verdict of ``qos_check_compatible``: OK, WARNING or ERROR
    :param documented: the prediction of the documented rule; None if the rule makes none
    :param became: the values that the middleware chose for publisher and subscription
    """

    offered: str
    requested: str
    matched: bool
    refused_for: tuple[str, ...]
    check: str
    reason: str
    documented: bool | None
    became: tuple[str, str]

    @property
    def agrees(self) -> bool:
        """Return whether the event, the check and the rule agree."""
        predicted = {'OK': True, 'ERROR': False}.get(self.check)
        return predicted == self.matched and self.documented in (None, self.matched)

    @property
    def explanation(self) -> str:
        """The reason why the check disagrees, or an empty string if it is unknown."""
        if self.agrees:
            return ''
        if self.check == 'WARNING' and 'SYSTEM_DEFAULT' in (self.offered, self.requested):
            return 'only the middleware knows what SYSTEM_DEFAULT means'
        if self.check == 'OK' and 'BEST_AVAILABLE' in (self.offered, self.requested):
            became = self.became[self.offered != 'BEST_AVAILABLE']
            return f'BEST_AVAILABLE was created first and became {became}'
        return ''

    @property
    def outcome(self) -> str:
        """The outcome in one or two words."""
        return 'match' if self.matched else f'no: {", ".join(sorted(set(self.refused_for)))}'

    @property
    def shown(self) -> str:
        """The outcome with a tick or a cross."""
        return f'{_SIGNS[self.matched]} {self.outcome}'

    def __str__(self) -> str:
        pair = f'{self.offered} offered, {self.requested} requested'
        said = f'the function says {self.check}'
        return f'{pair}: {self.outcome}, {said}; {self.explanation or "UNEXPLAINED"}'


class QosTable:
    """
    The outcomes of all pairs; a notebook shows them as a table.

    :param policy: name of the table, a key of :data:`CHOICES`
    :param first: the side of each pair that was created first
    """

    def __init__(self, policy: str, first: str, cells: Sequence[Cell]) -> None:
        self.policy = policy
        self.first = first
        self.cells = tuple(cells)

    def __getitem__(self, pair: tuple[str, str]) -> Cell:
        """Return the cell of a pair, which is given as (offered, requested)."""
        return next(cell for cell in self.cells if (cell.offered, cell.requested) == pair)

    @property
    def disagreements(self) -> list[Cell]:
        """Pairs for which the check or the documented rule gives a different outcome."""
        return [cell for cell in self.cells if not cell.agrees]

    @property
    def caption(self) -> str:
        """Return one sentence that describes the table."""
        matched = sum(cell.matched for cell in self.cells)
        return (
            f'{self.policy.capitalize()}: {len(self.cells)} pairs, {matched} matched, '
            f'{self.first} created first. Rows offer, columns request.'
        )

    def _rows(self) -> Iterator[tuple[str, list[Cell]]]:
        for offered in CHOICES[self.policy]:
            yield offered, [cell for cell in self.cells if cell.offered == offered]

    def __repr__(self) -> str:
        head = ['offered \\ requested', *CHOICES[self.policy]]
        rows = [head, *([name, *map(_text_of, cells)] for name, cells in self._rows())]
        return f'{self.caption}\n{text_table(rows)}'

    def _repr_html_(self) -> str:
        """Return a table with a caption and header cells, readable without colours."""
        rule = 'border: 1px solid currentColor; padding: 0.3em 0.6em; text-align: left'
        head = ''.join(
            f'<th scope="col" style="{rule}">{escape(name)}</th>' for name in CHOICES[self.policy]
        )
        body = ''.join(
            f'<tr><th scope="row" style="{rule}">{escape(name)}</th>'
            + ''.join(_html_of(cell, rule) for cell in cells)
            + '</tr>'
            for name, cells in self._rows()
        )
        return (
            f'<table><caption>{escape(self.caption)}</caption><thead><tr>'
            f'<th scope="col" style="{rule}">offered (down), requested (across)</th>{head}'
            f'</tr></thead><tbody>{body}</tbody></table>'
        )


def _text_of(cell: Cell) -> str:
    return cell.shown if cell.agrees else f'{cell.shown} (function: {cell.check})'


def _html_of(cell: Cell, rule: str) -> str:
    text = escape(cell.shown) if cell.matched else f'<b>{escape(cell.shown)}</b>'
    if not cell.agrees:
        text += f'<br><small>function: {cell.check}</small>'
    return f'<td style="{rule}; background: {_TINTS[cell.matched]}">{text}</td>'


def qos_table(policy: str = 'reliability and durability', *, first: str = 'publisher') -> QosTable:
    """
    Test every combination of a policy's values with real endpoints.

    :param policy: ``'reliability'``, ``'durability'``, ``'reliability and durability'``,
        ``'deadline'``, ``'liveliness'``, ``'lease'``, ``'lifespan'`` or ``'depth'``
    :param first: the side of each pair that is created first, ``'publisher'`` or
        ``'subscription'``; it only matters for BEST_AVAILABLE
    """
    if policy not in CHOICES:
        names = ', '.join(map(repr, CHOICES))
        raise RoslabError(f'qos_table() knows the tables {names}; got {policy!r}.')
    if first not in ('publisher', 'subscription'):
        raise RoslabError(f"first: expected 'publisher' or 'subscription', got {first!r}.")
    with HeldInterrupts(), _laboratory() as (node, executor):
        pairs = [
            _Pair(node, f'pair_{number}', one, other, first)
            for number, (one, other) in enumerate(product(CHOICES[policy].items(), repeat=2))
        ]
        _await_all(pairs, executor)
        return QosTable(policy, first, [pair.cell(policy) for pair in pairs])


@contextmanager
def _laboratory() -> Iterator[tuple[Node, SingleThreadedExecutor]]:
    """Provide a hidden node in a separate context, on topics that no other node uses."""
    context = Context()
    context.init(args=[])
    executor = SingleThreadedExecutor(context=context)
    try:
        node = Node(
            '_qos_table',
            namespace=f'_qos_table_{os.getpid()}_{next(_tables)}',
            context=context,
            enable_rosout=False,
            start_parameter_services=False,
        )
        executor.add_node(node)
        yield node, executor
        node.destroy_node()
    finally:
        executor.shutdown()
        context.try_shutdown()


class _Pair:
    """A publisher and a subscription on a separate topic, and the QoS events of both."""

    def __init__(
        self,
        node: Node,
        topic: str,
        offered: tuple[str, Choice],
        requested: tuple[str, Choice],
        first: str,
    ) -> None:
        self.node = node
        self.topic = topic
        self.names = (offered[0], requested[0])
        # Set AUTOMATIC, because the check cannot judge the default, SYSTEM_DEFAULT.
        base = {'depth': 1, 'liveliness': LivelinessPolicy.AUTOMATIC}
        self.profiles = tuple(QoSProfile(**{**base, **one[1]}) for one in (offered, requested))
        self.refusals: tuple[list[Any], list[Any]] = ([], [])
        make = [self._publish, self._subscribe]
        for one in make if first == 'publisher' else reversed(make):
            one()

    def _publish(self) -> None:
        events = PublisherEventCallbacks(incompatible_qos=self.refusals[0].append)
        self.publisher = self.node.create_publisher(
            Empty, self.topic, self.profiles[0], event_callbacks=events
        )

    def _subscribe(self) -> None:
        events = SubscriptionEventCallbacks(incompatible_qos=self.refusals[1].append)
        self.subscription = self.node.create_subscription(
            Empty, self.topic, lambda _: None, self.profiles[1], event_callbacks=events
        )

    @property
    def matched(self) -> bool:
        """Return whether each side has reported the other as matched."""
        return bool(
            self.publisher.get_subscription_count() and self.subscription.get_publisher_count()
        )

    @property
    def decided(self) -> bool:
        """Return whether both sides have reported the outcome of the pair."""
        return self.matched or all(self.refusals)

    def cell(self, policy: str) -> Cell:
        """Return the outcome of the pair."""
        verdict, reason = qos_check_compatible(*self.profiles)
        events = (*self.refusals[0], *self.refusals[1])
        ends = (
            *self.node.get_publishers_info_by_topic(self.topic),
            *self.node.get_subscriptions_info_by_topic(self.topic),
        )
        offered, requested = (_value(end.qos_profile, policy) for end in ends)
        return Cell(
            *self.names,
            matched=self.matched,
            refused_for=tuple(qos_policy_name_from_kind(one.last_policy_kind) for one in events),
            check=verdict.name,
            reason=reason,
            documented=documented(policy, *self.names),
            became=(offered, requested),
        )


def _value(profile: QoSProfile, policy: str) -> str:
    """Return the value of a named policy in an endpoint's profile, or an empty string."""
    return str(getattr(getattr(profile, policy, None), 'name', ''))


def _await_all(pairs: Sequence[_Pair], executor: SingleThreadedExecutor) -> None:
    """Process events until each pair is either matched or refused on both sides."""
    end = time.monotonic() + _PATIENCE_S
    while waiting := [pair for pair in pairs if not pair.decided]:
        if time.monotonic() > end:
            raise RoslabError(
                f'{len(waiting)} of {len(pairs)} pairs are neither matched nor refused after '
                f'{_PATIENCE_S:g} s, such as {waiting[0].names}. Is the machine very busy? '
                'Run the cell again.'
            )
        executor.spin_once(timeout_sec=0.05)


def documented(policy: str, offered: str, requested: str) -> bool | None:
    """Return whether an offer is as strong as a request; None if the documented rule is silent."""
    if policy in _NEVER_MATTERS:
        return True
    if any(name in _UNDECIDED for name in (offered, requested)):
        return None
    if policy == 'reliability and durability':
        pairs = zip(offered.split(', '), requested.split(', '), strict=True)
        return all(
            documented(which, *pair) is True
            for which, pair in zip(('reliability', 'durability'), pairs, strict=True)
        )
    strength = list(CHOICES[policy])
    return strength.index(offered) >= strength.index(requested)
