"""Test claims about executors, timers, callbacks and clocks with the real rclpy."""

from contextlib import suppress
import gc
import os
import subprocess
import threading
import time
import weakref

import pytest
from rcl_interfaces.srv import GetParameters
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.executors import (
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.parameter import Parameter
from rclpy.time import Time
from rclpy.wait_for_message import wait_for_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

claim = pytest.mark.claim
SOON_S = 60
pytestmark = pytest.mark.ros


def in_thread(work):
    """Start a daemon thread, so that a false claim cannot hang the tests."""
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread


def to_the_end(executor):
    def spin():
        # In rclpy 7.1.6, shutdown() may destroy a guard condition that spin() is about to use.
        with suppress(AttributeError, rclpy_implementation.InvalidHandle):
            executor.spin()

    return spin


@claim('X1', 'X8')
def test_spin_blocks_until_its_executor_is_shut_down(world):
    executor = SingleThreadedExecutor(context=world.context)
    ticked = threading.Event()
    world.executor.remove_node(node := world.node())
    node.create_timer(0.01, ticked.set)
    executor.add_node(node)
    thread = in_thread(to_the_end(executor))

    assert ticked.wait(SOON_S)
    assert thread.is_alive()
    executor.shutdown()
    thread.join(SOON_S)
    assert not thread.is_alive()


@claim('X8')
def test_shutdown_of_the_context_raises_where_somebody_spins(world):
    raised = []
    spinning = threading.Event()
    node = world.node()

    def tick():
        timer.cancel()
        spinning.set()

    timer = node.create_timer(0.01, tick)

    def spin():
        try:
            world.executor.spin()
        except ExternalShutdownException as error:
            raised.append(error)

    thread = in_thread(spin)
    assert spinning.wait(SOON_S)
    # Let the thread begin its wait: between two waits, spin() would return without an exception.
    thread.join(0.5)
    world.context.shutdown()
    thread.join(SOON_S)

    assert len(raised) == 1


@claim('X2')
def test_spin_once_without_time_does_not_wait(world):
    node, ticks = world.node(), []
    timer = node.create_timer(3600.0, lambda: ticks.append(1))
    world.drain()
    began = time.monotonic()
    world.executor.spin_once(timeout_sec=0)

    assert time.monotonic() - began < 60  # the timer's period is an hour
    assert ticks == []
    assert not timer.is_canceled()


@claim('X3')
def test_waiting_for_one_message_is_bounded(world):
    """wait_for_message returns the message, or reports that none arrived."""
    node = world.node()
    world.executor.remove_node(node)

    assert wait_for_message(String, node, 'silence', time_to_wait=0.05) == (False, None)


@claim('X3')
def test_spinning_until_a_future_is_done(world):
    node = world.node()
    node.create_service(GetParameters, 'ping', lambda _, response: response)
    future = node.create_client(GetParameters, 'ping').call_async(GetParameters.Request())
    world.executor.spin_until_future_complete(future, timeout_sec=10)

    assert future.done()


@claim('X4')
def test_messages_wait_until_somebody_spins(world):
    node, heard = world.node(), []
    publisher = node.create_publisher(String, 'chatter', 10)
    node.create_subscription(String, 'chatter', heard.append, 10)
    publisher.publish(String(data='waiting'))

    assert publisher.get_subscription_count() == 1
    assert heard == []
    world.spin_until(lambda: heard, what='the message')


@claim('X5')
def test_spin_once_takes_the_node_away_from_its_executor(world):
    """After rclpy.spin_once, the first executor has no node."""
    import rclpy

    node = world.node()
    assert world.executor.get_nodes() == [node]
    other = SingleThreadedExecutor(context=world.context)
    rclpy.spin_once(node, executor=other, timeout_sec=0)

    assert world.executor.get_nodes() == []


@claim('X7')
def test_exception_in_a_callback_leaves_spin(world):
    def fail():
        raise ZeroDivisionError('in a callback')

    world.node().create_timer(0.01, fail)

    with pytest.raises(ZeroDivisionError):
        world.executor.spin()


def most_at_once(world, *groups) -> int:
    """Return how many callbacks ran at once on four threads, with one timer per group."""
    node, now, most, lock = world.node(), [], [0], threading.Lock()
    world.executor.remove_node(node)
    done = threading.Event()

    def busy():
        with lock:
            now.append(1)
            most[0] = max(most[0], len(now))
        met = both.wait(0.3)
        with lock:
            now.pop()
        if met or len(calls) >= 4:
            done.set()
        calls.append(1)

    calls: list[int] = []
    both = Meeting(2)
    for group in groups:
        node.create_timer(0.01, busy, callback_group=group)
    executor = MultiThreadedExecutor(4, context=world.context)
    executor.add_node(node)
    in_thread(to_the_end(executor))
    assert done.wait(SOON_S)
    executor.shutdown()
    return most[0]


class Meeting:
    """Records whether a number of threads ran at the same time."""

    def __init__(self, count):
        self.barrier = threading.Barrier(count)

    def wait(self, seconds):
        try:
            self.barrier.wait(seconds)
        except threading.BrokenBarrierError:
            self.barrier.reset()
            return False
        return True


@claim('X9')
def test_callbacks_exclude_each_other_unless_their_group_is_reentrant(world):
    """Four threads make no difference to the default group."""
    everybody = ReentrantCallbackGroup()

    assert most_at_once(world, None, None) == 1
    assert most_at_once(world, everybody, everybody) >= 2


@claim('X22')
def test_callbacks_of_different_exclusive_groups_run_at_the_same_time(world):
    one, other = MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()
    assert most_at_once(world, one, other) == 2

    # A new group, because an executor that is shut down may leave a call in its group forever.
    shared = MutuallyExclusiveCallbackGroup()
    assert most_at_once(world, shared, shared) == 1


@claim('X22')
def test_callback_overlaps_with_itself_in_a_reentrant_group_only(world):
    assert most_at_once(world, ReentrantCallbackGroup()) >= 2
    assert most_at_once(world, MutuallyExclusiveCallbackGroup()) == 1


@claim('X23')
def test_executor_has_as_many_threads_as_there_are_processors(world):
    """On one processor, an executor without a number of threads runs one callback at a time."""
    executor = MultiThreadedExecutor(context=world.context)

    assert executor._executor._max_workers == len(os.sched_getaffinity(0))
    executor.shutdown()


@claim('X10')
def test_entity_keeps_its_callback_group_alive(world):
    node, group = world.node(), ReentrantCallbackGroup()
    timer = node.create_timer(60.0, lambda: None, callback_group=group)
    kept, members = weakref.ref(group), group.entities
    assert all(isinstance(member, weakref.ref) for member in members)
    assert [member() for member in members] == [timer]

    del group
    gc.collect()
    assert timer.callback_group is kept()

    node.destroy_timer(timer)
    del timer
    gc.collect()
    assert kept() is None


@claim('X11')
def test_synchronous_call_in_a_callback_never_returns(world):
    """The response needs the thread that waits for it; call_async does not block the thread."""
    node = world.node()
    node.create_service(GetParameters, 'ping', lambda _, response: response)
    client = node.create_client(GetParameters, 'ping')
    answers, futures = [], []

    def call():
        timer.cancel()
        futures.append(client.call_async(GetParameters.Request()))
        answers.append(client.call(GetParameters.Request(), timeout_sec=0.3))

    timer = node.create_timer(0.01, call)
    world.spin_until(lambda: answers, what='the end of the synchronous call')
    assert answers == [None]  # None means a timeout
    world.spin_until(lambda: futures[0].done(), what='the answer to the other call')


@claim('X12')
def test_one_callback_stops_all_others(world):
    node, ticks, seen = world.node(), [], []
    node.create_timer(0.01, lambda: ticks.append(1))

    def long_work():
        before = len(ticks)
        time.sleep(0.1)  # ten periods of the other timer: the claim itself
        seen.append(len(ticks) - before)

    node.create_timer(0.02, long_work)
    world.spin_until(lambda: seen, what='the long callback')

    assert seen[0] == 0


def clock_at(world, nanoseconds):
    """Publish a simulated time and wait until the node shows it."""
    world.ticker.publish(Clock(clock=Time(nanoseconds=nanoseconds).to_msg()))
    world.spin_until(
        lambda: world.subject.get_clock().now().nanoseconds == nanoseconds, what='the clock'
    )
    world.drain()


@pytest.fixture
def simulated(world):
    """Return a world with a node in simulated time, stepped by clock_at."""
    world.subject = world.node(
        'subject', parameter_overrides=[Parameter('use_sim_time', value=True)]
    )
    world.ticker = world.node('ticker').create_publisher(Clock, '/clock', 10)
    world.spin_until(lambda: world.ticker.get_subscription_count() == 1, what='the node')
    return world


@claim('X13', 'X14')
def test_first_tick_after_a_period_and_missed_ones_are_skipped(simulated):
    """There is no tick after 0.5 s, one after 1 s, and at most two after a jump of 10 s."""
    clock_at(simulated, 1)
    ticks = []
    simulated.subject.create_timer(1.0, lambda: ticks.append(1))
    clock_at(simulated, 500_000_000)
    assert ticks == []
    clock_at(simulated, 1_100_000_000)
    assert len(ticks) == 1
    clock_at(simulated, 11_600_000_000)
    assert len(ticks) <= 3


@claim('X16')
def test_without_a_clock_simulated_time_stands_at_zero(simulated):
    ticks = []
    simulated.subject.create_timer(0.01, lambda: ticks.append(1))
    witness = []
    simulated.node('witness').create_timer(0.01, lambda: witness.append(1))
    simulated.spin_until(lambda: len(witness) >= 10, what='ten ticks of a node in real time')

    assert simulated.subject.get_clock().now().nanoseconds == 0
    assert len(ticks) <= 1


@claim('X17')
def test_timers_are_stopped_and_started(world):
    node, ticks = world.node(), []
    timer = node.create_timer(0.01, lambda: ticks.append(1), autostart=False)
    assert timer.is_canceled()
    timer.reset()
    world.spin_until(lambda: ticks, what='a tick after reset')
    timer.cancel()
    world.drain()
    ticks.clear()
    witness = []
    node.create_timer(0.01, lambda: witness.append(1))
    world.spin_until(lambda: len(witness) >= 3, what='three ticks of another timer')

    assert ticks == []


@claim('Q24')
def test_timer_that_each_message_resets_ticks_once_in_a_silence(simulated):
    stops = []

    def stop():
        timer.cancel()
        stops.append(simulated.subject.get_clock().now().nanoseconds)

    timer = simulated.subject.create_timer(0.5, stop, autostart=False)
    for tenths in (10, 14, 18, 22):  # a message arrives
        clock_at(simulated, tenths * 100_000_000)
        timer.reset()
    for tenths in range(23, 40):
        clock_at(simulated, tenths * 100_000_000)

    assert stops == [2_700_000_000]


@claim('X11')
def test_rate_in_a_callback_never_wakes(world):
    """The rate waits for a timer that only the blocked thread could serve."""
    node = world.node()
    rate = node.create_rate(100.0)
    woken = threading.Event()
    entered = threading.Event()

    def sleep_once():
        rate.sleep()  # may return at once if the rate's timer has already fired
        entered.set()
        rate.sleep()
        woken.set()

    node.create_timer(0.01, sleep_once)
    thread = in_thread(to_the_end(world.executor))
    entered.wait(0.5)
    assert not woken.wait(0.5)  # fifty periods
    world.executor.shutdown(timeout_sec=0)  # first; otherwise, a tick would use a destroyed rate
    rate.destroy()
    thread.join(SOON_S)


@claim('X19')
def test_callback_takes_message_and_info(world):
    """The second parameter contains the times of sending and receiving."""
    node, heard = world.node(), []
    node.create_subscription(String, 'chatter', lambda m, info: heard.append((m, info)), 10)
    node.create_publisher(String, 'chatter', 10).publish(String(data='x'))
    world.spin_until(lambda: heard, what='the message')
    info = heard[0][1]

    assert info['received_timestamp'] >= info['source_timestamp'] > 0
    with pytest.raises(RuntimeError):
        node.create_subscription(String, 'chatter', lambda: None, 10)


@claim('X20')
def test_time_of_the_clock_becomes_a_stamp_and_back(world):
    """A difference of two times is a duration; times of different clock types cannot be mixed."""
    now = world.node().get_clock().now()
    stamp = now.to_msg()

    assert Time.from_msg(stamp, clock_type=ClockType.ROS_TIME) == now
    assert now - Time.from_msg(stamp, clock_type=ClockType.ROS_TIME) == Duration()


@claim('X21')
def test_callbacks_run_where_somebody_spins(world):
    where = []
    world.node().create_timer(0.01, lambda: where.append(threading.get_ident()))
    thread = in_thread(lambda: world.spin_until(lambda: where, what='a tick'))
    thread.join(20)

    assert where[0] == thread.ident
    assert where[0] != threading.get_ident()


@claim('J8')
def test_variables_of_a_child_shell_end_with_it():
    said = subprocess.run(
        ['sh', '-c', 'export TASTE=sweet; echo $TASTE'], capture_output=True, text=True, check=True
    )

    assert said.stdout == 'sweet\n'
    assert 'TASTE' not in os.environ
