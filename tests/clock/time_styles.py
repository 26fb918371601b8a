"""
The ways in which ROS programs keep time.

``STYLES`` has the body of each program and the seconds at which its numbers are published if its
period ``P`` is one second.  The node's ``tick`` publishes the next number.  ``ANSWERING`` programs
double each input.  ``program`` turns a body into a program.
"""

from collections.abc import Sequence
from textwrap import indent

from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, feeds

WATCHED = Scenario(file='style.py', watch={'/n': 'std_msgs/msg/Int32'}, steps=(Advance(19.8),))
INPUTS = [float(number) for number in range(25)]
BURST = 5
ASKED = Scenario(
    file='style.py',
    watch={'/answer': 'std_msgs/msg/Float64'},
    feed={'/input': 'std_msgs/msg/Float64'},
    steps=feeds('/input', [{'data': one} for one in INPUTS], BURST, every_s=0.5),
)

BEGIN = """
import asyncio, concurrent.futures, ctypes, multiprocessing, os, queue, sched, select, signal
import socket, struct, subprocess, threading, time
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import MultiThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from rcl_interfaces.srv import GetParameters
from std_msgs.msg import Float64, Int32

P = 1.0  # the period [s]

class Numbers(Node):
    def __init__(self):
        super().__init__('numbers')
        self.publisher, self.number = self.create_publisher(Int32, 'n', 10), 0

    def tick(self):
        self.number += 1
        self.publisher.publish(Int32(data=self.number))

def spin(executor):
    executor.add_node(node)
    executor.spin()

def spin_aside():
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()

if __name__ == '__main__':
    rclpy.init()
"""


def program(body: str) -> str:
    """
    Return the text of a program.

    :param body: code that uses ``node``; a body that creates the node itself contains ``node =``
    """
    return BEGIN + indent(body if 'node = ' in body else f'node = Numbers()\n{body}', '    ')


EVERY_SECOND = [float(second) for second in range(1, 21)]
LOOP = 'while True: {wait}; node.tick()'
TIMER = 'node.create_timer(P, node.tick); '

STYLES: dict[str, tuple[str, Sequence[float]]] = {
    'timer': (TIMER + 'rclpy.spin(node)', EVERY_SECOND),
    'timer on STEADY': (
        'node.create_timer(P, node.tick, clock=Clock(clock_type=ClockType.STEADY_TIME))\n'
        'rclpy.spin(node)',
        EVERY_SECOND,
    ),
    'timer on SYSTEM': (
        'node.create_timer(P, node.tick, clock=Clock(clock_type=ClockType.SYSTEM_TIME))\n'
        'rclpy.spin(node)',
        EVERY_SECOND,
    ),
    'EventsExecutor': (TIMER + 'spin(EventsExecutor())', EVERY_SECOND),
    'MultiThreadedExecutor': (TIMER + 'spin(MultiThreadedExecutor())', EVERY_SECOND),
    'reentrant callbacks': (
        'group = ReentrantCallbackGroup()\n'
        'node.create_timer(P, node.tick, callback_group=group)\n'
        'node.create_timer(0.25, lambda: time.sleep(0.4), callback_group=group)\n'
        'spin(MultiThreadedExecutor(num_threads=8))',
        EVERY_SECOND,
    ),
    'spin_once(1.0)': (
        TIMER + '\nwhile True: rclpy.spin_once(node, timeout_sec=P)',
        EVERY_SECOND,
    ),
    'spin_once(0.1)': (
        TIMER + '\nwhile True: rclpy.spin_once(node, timeout_sec=0.1)',
        EVERY_SECOND,
    ),
    'spin_once()': (TIMER + '\nwhile True: rclpy.spin_once(node)', EVERY_SECOND),
    'create_rate': (
        'spin_aside()\nrate = node.create_rate(1 / P)\n' + LOOP.format(wait='rate.sleep()'),
        EVERY_SECOND,
    ),
    'sleep_for': (
        LOOP.format(wait='node.get_clock().sleep_for(Duration(seconds=P))'),
        EVERY_SECOND,
    ),
    'sleep_until': (
        'due = node.get_clock().now()\n'
        'while True:\n due += Duration(seconds=P)\n node.get_clock().sleep_until(due)\n '
        'node.tick()',
        EVERY_SECOND,
    ),
    # The first number is lost: it is published before the listener has been discovered.
    'publish and sleep': ('while True: node.tick(); time.sleep(P)', EVERY_SECOND),
    'threading.Timer': (
        'def later(): node.tick(); threading.Timer(P, later).start()\n'
        'threading.Timer(P, later).start()\nrclpy.spin(node)',
        EVERY_SECOND,
    ),
    'Event.wait': (
        'event = threading.Event()\n' + LOOP.format(wait='event.wait(P)'),
        EVERY_SECOND,
    ),
    'Condition.wait': (
        'condition = threading.Condition()\n'
        'while True:\n with condition: condition.wait(P)\n node.tick()',
        EVERY_SECOND,
    ),
    'Queue.get': (
        'numbers = queue.Queue()\nwhile True:\n try: numbers.get(timeout=P)\n'
        ' except queue.Empty: node.tick()',
        EVERY_SECOND,
    ),
    'asyncio': (
        f'async def main():\n {LOOP.format(wait="await asyncio.sleep(P)")}\nasyncio.run(main())',
        EVERY_SECOND,
    ),
    'asyncio beside spin': (
        'spin_aside()\n'
        f'async def main():\n {LOOP.format(wait="await asyncio.sleep(P)")}\nasyncio.run(main())',
        EVERY_SECOND,
    ),
    'sched': (
        'plan = sched.scheduler()\ndef later(): node.tick(); plan.enter(P, 1, later)\n'
        'plan.enter(P, 1, later)\nplan.run()',
        EVERY_SECOND,
    ),
    'concurrent.futures': (
        'pool = concurrent.futures.ThreadPoolExecutor(2)\n'
        + LOOP.format(wait='pool.submit(time.sleep, P).result()'),
        EVERY_SECOND,
    ),
    'select': (LOOP.format(wait='select.select([], [], [], P)'), EVERY_SECOND),
    'sockets': (
        'ours, theirs = socket.socketpair()\n'
        'def send():\n while True: time.sleep(P); theirs.send(b"x")\n'
        'threading.Thread(target=send, daemon=True).start()\n' + LOOP.format(wait='ours.recv(1)'),
        EVERY_SECOND,
    ),
    'setitimer': (
        'signal.signal(signal.SIGALRM, lambda *_: node.tick())\n'
        'signal.setitimer(signal.ITIMER_REAL, P, P)\nwhile True: signal.pause()',
        EVERY_SECOND,
    ),
    'alarm': (
        'def later(*_): node.tick(); signal.alarm(1)\n'
        'signal.signal(signal.SIGALRM, later)\nsignal.alarm(1)\nwhile True: time.sleep(100)',
        EVERY_SECOND,
    ),
    'timerfd': (
        'libc = ctypes.CDLL(None)\nfd = libc.timerfd_create(1, 0)\n'
        'every = divmod(round(P * 10**9), 10**9)\n'
        'libc.timerfd_settime(fd, 0, struct.pack("qqqq", *every, *every), None)\n'
        + LOOP.format(wait='os.read(fd, 8)'),
        EVERY_SECOND,
    ),
    'subprocess': (LOOP.format(wait='subprocess.run(["sleep", str(P)])'), EVERY_SECOND),
    'os.system': (LOOP.format(wait='os.system(f"sleep {P}")'), EVERY_SECOND),
    'multiprocessing.Queue': (
        'def work(numbers):\n while True: time.sleep(P); numbers.put(1)\n'
        'numbers = multiprocessing.Queue()\n'
        'multiprocessing.Process(target=work, args=(numbers,), daemon=True).start()\n'
        + LOOP.format(wait='numbers.get()'),
        EVERY_SECOND,
    ),
    'call in a callback': (
        'group = ReentrantCallbackGroup()\n'
        'name = node.get_name() + "/get_parameters"\n'
        'client = node.create_client(GetParameters, name, callback_group=group)\n'
        'def ask(): client.call(GetParameters.Request(names=["use_sim_time"])); node.tick()\n'
        'node.create_timer(P, ask, callback_group=group)\nspin(MultiThreadedExecutor())',
        EVERY_SECOND,
    ),
    'sleep in a callback': (
        'def slow(): time.sleep(0.3); node.tick()\nnode.create_timer(P, slow)\nrclpy.spin(node)',
        [second + 0.3 for second in EVERY_SECOND],
    ),
    'sleep longer than the period': (
        'def slow(): time.sleep(2.0); node.tick()\nnode.create_timer(0.5, slow)\nrclpy.spin(node)',
        [second + 0.5 for second in range(2, 20, 2)],
    ),
    'sleep before the timer': (
        'time.sleep(3)\n' + TIMER + 'rclpy.spin(node)',
        [second for second in EVERY_SECOND if second > 3],
    ),
    'sleep in __init__': (
        'class Slow(Numbers):\n'
        ' def __init__(self): super().__init__(); time.sleep(3); self.create_timer(P, self.tick)\n'
        'node = Slow()\nrclpy.spin(node)',
        [second for second in EVERY_SECOND if second > 3],
    ),
    'polling time()': (
        'due = time.time() + P\nwhile True:\n if time.time() >= due: node.tick(); due += P',
        EVERY_SECOND,
    ),
    'polling monotonic()': (
        'due = time.monotonic() + P\n'
        'while True:\n if time.monotonic() >= due: node.tick(); due += P',
        EVERY_SECOND,
    ),
    'polling now()': (
        'due = node.get_clock().now() + Duration(seconds=P)\n'
        'while True:\n if node.get_clock().now() >= due: node.tick(); due += Duration(seconds=P)',
        EVERY_SECOND,
    ),
    'spin_once(0) and now()': (
        'due = node.get_clock().now() + Duration(seconds=P)\n'
        'while True:\n rclpy.spin_once(node, timeout_sec=0)\n'
        ' if node.get_clock().now() >= due: node.tick(); due += Duration(seconds=P)',
        EVERY_SECOND,
    ),
    'thread at 1 kHz': (
        'def busy():\n while True: time.sleep(0.001)\n'
        'threading.Thread(target=busy, daemon=True).start()\n' + TIMER + 'rclpy.spin(node)',
        EVERY_SECOND,
    ),
    # The loop begins only when the program has a node; otherwise a different limit ends the run.
    'thread that never waits': (
        'def busy():\n while True: pass\nthreading.Timer(P * 5.5, busy).start()\n'
        + TIMER
        + 'rclpy.spin(node)',
        EVERY_SECOND[:5],
    ),
    'node that ends by itself': (
        TIMER + '\nwhile node.number < 7: rclpy.spin_once(node)\nrclpy.shutdown()',
        EVERY_SECOND[:7],
    ),
    'deadline and liveliness': (
        'qos = QoSProfile(depth=10, deadline=Duration(seconds=0.7), '
        'liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, '
        'liveliness_lease_duration=Duration(seconds=0.4))\n'
        'publisher = node.create_publisher(Int32, "d", qos)\n'
        'logger = node.get_logger()\n'
        'events = SubscriptionEventCallbacks(deadline=lambda _: logger.warn("late"), '
        'liveliness=lambda event: logger.info(f"alive {event.alive_count}"))\n'
        'node.create_subscription(Int32, "d", lambda _: None, qos, event_callbacks=events)\n'
        'def both(): node.tick(); publisher.publish(Int32(data=node.number))\n'
        'node.create_timer(P, both)\nrclpy.spin(node)',
        EVERY_SECOND,
    ),
    # While the callback sleeps, messages older than half a second expire in the queue.
    'lifespan': (
        'qos = QoSProfile(depth=10, lifespan=Duration(seconds=0.5))\n'
        'publisher = node.create_publisher(Int32, "d", qos)\n'
        'def slow(_): time.sleep(2.2); node.tick()\n'
        'node.create_subscription(Int32, "d", slow, qos)\n'
        'node.create_timer(P, lambda: publisher.publish(Int32()), '
        'callback_group=ReentrantCallbackGroup())\nspin(MultiThreadedExecutor())',
        [3.2, 5.4, 7.6, 10.2, 12.4, 14.6, 17.2, 19.4],
    ),
}
ENDS = {'thread that never waits': 'cpu_limit', 'node that ends by itself': 'student_exited'}
"""Why a run ends before its scenario."""
LOGS = {
    # Each message asserts that the publisher is alive. The run ends before the last deadline.
    'deadline and liveliness': [
        (second + after_s, text)
        for second in EVERY_SECOND
        for after_s, text in ((0.0, 'alive 1'), (0.4, 'alive 0'), (0.7, 'late'))
    ][:-1],
}
"""The times [s] and texts of a program's log lines."""

ANSWERS = """
publisher = node.create_publisher(Float64, 'answer', 100)
waiting = queue.Queue()

def answer(message):
    {before}
    publisher.publish(Float64(data=2 * message.data))
    node.get_logger().info(f'got {{message.data:g}}')

def work():
    while True: answer(waiting.get())

threading.Thread(target=work, daemon=True).start()
node.create_subscription(Float64, 'input', {callback}, 10)
{spin}
"""
ANSWERING = {
    'at once': ANSWERS.format(before='', callback='answer', spin='rclpy.spin(node)'),
    'by several threads': ANSWERS.format(
        before='', callback='answer', spin='spin(MultiThreadedExecutor())'
    ),
    'by events': ANSWERS.format(before='', callback='answer', spin='spin(EventsExecutor())'),
    'by a thread of its own': ANSWERS.format(
        before='', callback='waiting.put', spin='rclpy.spin(node)'
    ),
    'late': ANSWERS.format(
        before='time.sleep(0.0625)', callback='answer', spin='rclpy.spin(node)'
    ),
}
