"""The record of callbacks and its picture, from real nodes and executors."""

from contextlib import ExitStack
from itertools import combinations, pairwise
import re
import threading

import pytest

rclpy = pytest.importorskip('rclpy')

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Int32

from roslab import callback_picture, callbacks, watch_callbacks
from roslab.errors import RoslabError
from tests.own_domain import own_domain

pytestmark = pytest.mark.ros
SOON_S = 60.0


@pytest.fixture
def context():
    """Return a context in a separate domain."""
    with ExitStack() as until:
        made = Context()
        made.init(args=[], domain_id=own_domain(until))
        yield made
        made.try_shutdown()


def spin(executor, condition):
    while not condition():
        executor.spin_once(timeout_sec=SOON_S)


def executor_of(*nodes, threads=1):
    context = nodes[0].context
    made = (
        SingleThreadedExecutor(context=context)
        if threads == 1
        else MultiThreadedExecutor(threads, context=context)
    )
    for node in nodes:
        made.add_node(node)
    return made


def overlapping(calls):
    """Return the pairs of callbacks that ran at the same time."""
    return [
        (one, other)
        for one, other in combinations(calls, 2)
        if one.began < other.ended and other.began < one.ended
    ]


def test_one_executor_runs_the_callbacks_of_two_nodes_one_after_the_other(context):
    """All callbacks have one thread, none overlaps, and each begins after it was due."""
    nodes = [Node(name, context=context) for name in ('lookout', 'keeper')]
    for node in nodes:
        node.create_timer(0.01, lambda: sum(range(100_000)))
    executor = executor_of(*nodes)

    with watch_callbacks() as seen:
        spin(executor, lambda: {call.source.node for call in seen.calls} == {'lookout', 'keeper'})
        spin(executor, lambda: len(seen.calls) > 5)

    assert {call.thread for call in seen.calls} == {1}
    assert all(one.ended <= later.began for one, later in pairwise(seen.calls))
    assert all(0 < call.came <= call.began <= call.ended <= seen.end for call in seen.calls)


def test_ticks_during_a_slow_callback_are_one_late_call_and_skipped_ones(context):
    """No tick runs during the slow callback; the skipped ticks were due during it."""
    node, times = Node('sleeper', context=context), []

    def long_work():
        slow.cancel()
        threading.Event().wait(0.2)

    node.create_timer(0.01, lambda: times.append(1))
    slow = node.create_timer(0.05, long_work)
    executor = executor_of(node)
    with watch_callbacks() as seen:
        spin(executor, lambda: any(call.source.function for call in seen.calls))
        before = len(times)
        spin(executor, lambda: len(times) > before + 2)

    (work,) = [call for call in seen.calls if call.source.function == 'long_work']
    ticks = [call for call in seen.calls if call is not work]
    after = next(call for call in ticks if call.began >= work.ended)
    assert not overlapping(seen.calls)
    assert after.came < work.ended
    assert len([tick for tick in seen.lost if work.began < tick.came < work.ended]) > 10
    assert all(tick.began is None and tick.ended is None for tick in seen.lost)


def test_tick_that_is_due_at_the_end_waits_and_later_ones_are_lost(context):
    """The executor was not spun again, so the picture shows one waiting call for all ticks."""
    node = Node('keeper', context=context)
    timer = node.create_timer(0.05, lambda: None)
    executor = executor_of(node)

    with watch_callbacks() as seen:
        spin(executor, lambda: seen.calls)
        threading.Event().wait(timer.time_until_next_call() / 1e9 + 0.12)

    (waiting,) = [call for call in seen.events if call.began is None and not call.lost]
    lost = [tick.came for tick in seen.lost if tick.came > waiting.came]
    assert len(lost) >= 2
    assert lost[-1] <= seen.end <= lost[-1] + timer.timer_period_ns / 1e9
    assert '1 waiting' in seen._repr_html_()


def test_ticks_that_were_skipped_before_the_watch_are_not_recorded(context):
    """The node was spun late; recording all missed ticks would fill the record."""
    node = Node('sleeper', context=context)
    # Ticks that a busy machine skips during the watch must not fill the record.
    node.create_timer(0.02, lambda: None)
    executor = executor_of(node)
    threading.Event().wait(0.1)
    with watch_callbacks() as seen:
        spin(executor, lambda: seen.calls)

    assert seen.calls[0].came < 0
    assert all(tick.came >= 0 for tick in seen.lost)


@pytest.mark.parametrize(
    ('groups', 'names'),
    [
        ((None, None), ['', '']),
        ((MutuallyExclusiveCallbackGroup,) * 2, ['group 1', 'group 2']),
        ((ReentrantCallbackGroup,), ['reentrant group 1'] * 2),
        ((MutuallyExclusiveCallbackGroup,), ['group 1'] * 2),
    ],
    ids=['default', 'separate', 'reentrant', 'shared'],
)
def test_callbacks_are_side_by_side_exactly_if_their_groups_allow_it(context, groups, names):
    """Two timers that meet have different threads and overlapping boxes; others have neither."""
    node = Node('subject', context=context)
    made = [group and group() for group in groups]
    meet = names not in (['', ''], ['group 1'] * 2)
    meeting = threading.Barrier(2)

    def work(number):
        timers[number].cancel()
        if meet:
            meeting.wait(SOON_S)
        else:
            threading.Event().wait(0.05)  # long enough for the other one to begin if it may

    # In a reentrant group, a tick that is due again before cancel() raises an error in rclpy.
    timers = [
        node.create_timer(0.3, lambda n=n: work(n), callback_group=made[n % len(made)])
        for n in (0, 1)
    ]
    executor = executor_of(node, threads=4)
    with watch_callbacks(node) as seen:
        while len(seen.calls) < 2:
            executor.spin_once(timeout_sec=0.01)

    assert sorted(call.source.group for call in seen.calls) == names
    assert len(overlapping(seen.calls)) == meet
    assert {call.thread for call in seen.calls} == {1, 2} or not meet


def test_callback_that_overlaps_with_itself_has_two_lanes(context):
    """Both boxes are in the row of the same timer, the second below the first."""
    node, meeting = Node('hasty', context=context), threading.Barrier(2)
    group = ReentrantCallbackGroup()

    def work():
        if meeting.wait(SOON_S) == 0:
            timer.cancel()

    timer = node.create_timer(0.01, work, callback_group=group)
    executor = executor_of(node, threads=2)
    with watch_callbacks(node) as seen:
        while len(seen.calls) < 2:
            executor.spin_once(timeout_sec=0.01)

    assert overlapping(seen.calls[:2])
    assert callback_picture._levels(seen.calls[:2], seen.end) == [0, 1]


def test_messages_wait_until_the_node_is_spun_and_the_queue_loses_the_oldest(context):
    """Of ten messages the last three get a callback; two later ones wait."""
    node, heard = Node('slow', context=context), []
    node.create_subscription(Int32, 'burst', lambda m: heard.append(m.data), 3)
    burst = node.create_publisher(Int32, 'burst', 10)
    executor = executor_of(node)
    with watch_callbacks() as seen:
        for number in range(10):
            burst.publish(Int32(data=number))
        began = seen._seconds(callbacks.time.time_ns())
        spin(executor, lambda: 9 in heard)
        burst.publish(Int32(data=10))
        burst.publish(Int32(data=11))

    assert heard == [7, 8, 9]
    assert [(call.came < began < call.began) for call in seen.calls] == [True] * 3
    assert len(seen.lost) == 7
    assert all(one.came < seen.calls[0].came for one in seen.lost)
    assert '3 called, 7 not, 2 waiting' in seen._repr_html_()
    assert str(seen).count('no callback') == 7
    assert str(seen).count('not yet') == 2


def test_messages_of_a_node_that_is_not_named_are_ignored(context):
    """A name or a full name selects a node, like the node itself."""
    nodes = [Node(name, context=context) for name in ('one', 'two')]
    nodes.append(Node('one', namespace='other', context=context))
    for node in nodes:
        node.create_timer(0.005, lambda: None)
    executor = executor_of(*nodes)
    for choice, sources in ((nodes[0], 1), ('/one', 1), ('one', 2)):
        with watch_callbacks(choice) as seen:
            spin(executor, lambda: len(seen.calls) > 3)
            spin(executor, lambda: len({id(call.source) for call in seen.calls}) == sources)  # noqa: B023
        assert {call.source.node for call in seen.calls} == {'one'}
        assert len({id(call.source) for call in seen.calls}) == sources


def test_timer_in_simulated_time_has_no_due_time(context):
    """The picture's axis is real time, so simulated times cannot be shown on it."""
    simulated = [Parameter('use_sim_time', value=True)]
    node, ticks = Node('sim', context=context, parameter_overrides=simulated), []
    clock = node.create_publisher(Clock, '/clock', QoSProfile(depth=10))
    executor = executor_of(node)

    def set_clock(second):
        message = Clock()
        message.clock.sec = second
        clock.publish(message)
        spin(executor, lambda: node.get_clock().now().nanoseconds == second * 10**9)

    set_clock(1)
    node.create_timer(1.0, lambda: ticks.append(1))
    with watch_callbacks() as seen:
        set_clock(5)
        spin(executor, lambda: ticks)

    (tick,) = [call for call in seen.calls if call.source.name == 'timer 1 s']
    assert tick.came is None
    assert not seen.lost
    assert seen._repr_html_().count('<svg') == 1


def test_callback_that_raises_is_recorded_and_rclpy_is_restored(context):
    """The exception reaches the code that spins, and a watch leaves nothing behind."""
    make, publish = Executor._make_handler, Publisher.publish
    node = Node('faulty', context=context)
    node.create_timer(0.005, lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError), watch_callbacks() as seen:
        spin(executor_of(node), lambda: False)

    assert len(seen.calls) == 1
    assert (Executor._make_handler, Publisher.publish) == (make, publish)


def test_callback_that_has_not_ended_is_drawn_until_the_end(context):
    """The call is unfinished, but has a box."""
    node, free = Node('stuck', context=context), threading.Event()
    node.create_timer(0.005, lambda: free.wait(SOON_S))
    executor = executor_of(node, threads=2)
    with watch_callbacks() as seen:
        while not seen.events:
            executor.spin_once(timeout_sec=0.01)
    free.set()

    assert seen.calls == []
    begin = max(0.0, min(time for call in seen.events for time in call.times))
    assert f'Callbacks in {seen.end - begin:.2f} seconds' in seen._repr_html_()
    assert '<rect' in seen._repr_html_()


def test_picture_has_words_a_legend_and_its_data(context):
    """Each callback is a row of the table, with the name of its function."""
    node = Node('worker', context=context)

    def look(message):
        """Take a message."""

    node.create_subscription(Int32, 'notes', look, 10)
    node.create_publisher(Int32, 'notes', 10).publish(Int32())
    with watch_callbacks() as seen:
        spin(executor_of(node), lambda: seen.calls)

    page = seen._repr_html_()
    table = re.search('<tbody>(.*)</tbody>', page)[1]
    assert 'worker · look, /notes: 1 called' in page
    assert 'cross: no callback' in page
    assert table.count('<tr>') == 1
    assert '/notes look' in table


def test_node_that_is_destroyed_while_it_is_ready_is_left_to_rclpy(context):
    """The code of rclpy expects this case and takes nothing."""
    node = Node('mayfly', context=context)
    timer = node.create_timer(0.005, lambda: None)
    node.destroy_node()
    with watch_callbacks() as seen:
        taken = seen.take(node, lambda entity: entity, timer)

    assert taken is timer
    assert not seen.events


def test_empty_record_is_a_table_without_rows():
    """Nothing was spun, so there is nothing to draw."""
    with watch_callbacks() as seen:
        pass

    assert seen._repr_html_() is None
    assert str(seen).splitlines() == [
        'node  callback of  group  thread  came [s]  began [s]  ended [s]'
    ]


def test_long_watch_stays_small(context, monkeypatch):
    """The watch records the first callbacks and reports the limit."""
    monkeypatch.setattr(callbacks, 'MAX_CALLS', 5)
    node, ticks = Node('fast', context=context), []
    node.create_timer(0.001, lambda: ticks.append(1))
    with watch_callbacks() as seen:
        spin(executor_of(node), lambda: len(ticks) > 9)

    assert len(seen.events) == 5
    assert str(seen).endswith('later callbacks are not recorded')


def test_something_else_than_a_node_is_refused():
    with pytest.raises(RoslabError, match=r'Try: watch_callbacks\(\) for all nodes'):
        watch_callbacks(5)
