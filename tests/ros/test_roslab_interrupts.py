"""Interrupts in real notebook kernels end a blocking cell, and ROS and the nodes keep running."""

import ast
import random

import live_kernels
from live_kernels import TALKER
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

kernel, kernel_to_share = live_kernels.kernel, live_kernels.kernel_to_share
new_kernel = live_kernels.new_kernel
kernel_with_node = live_kernels.kernel_with_node


def test_interrupt_ends_a_wait_and_nothing_else(kernel):
    kernel.run(TALKER)
    kernel.run('node = start(Talker)')
    outputs = kernel.interrupt_at(
        'print("waiting", flush=True); wait_until(lambda: False, 60)', 'waiting'
    )

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    after = kernel.run('n = node.count; wait_until(lambda: node.count > n + 3, 5); rclpy.ok()')
    assert after.value == 'True'


BLOCKING = {
    'spin': 'rclpy.spin(idle)',
    'spin_once': 'rclpy.spin_once(idle)',
    'spin_until_future_complete': 'rclpy.spin_until_future_complete(idle, rclpy.Future())',
    'a loop of spin_once': 'while True: rclpy.spin_once(idle, timeout_sec=0.1)',
    'executor.spin': 'one = SingleThreadedExecutor(); one.add_node(idle); one.spin()',
    'threads': 'many = MultiThreadedExecutor(2); many.add_node(idle); many.spin()',
    'wait_for_message': 'wait_for_message(String, idle, "silence")',
    'wait_until': 'wait_until(lambda: False, 60)',
    'Listener.wait': 'heard = listen("silence", String); heard.wait(1, timeout=60)',
    'plain Python': 'while True: pass',
    'a command': '!sleep 60\nwait_until(lambda: False, 60)',
    'output of a command': 'said = !sleep 60\nwait_until(lambda: False, 60)',
    # Python drops exceptions raised there.
    'a callback of a weak reference': 'gone = ref(thing, for_a_second); del thing\n'
    'wait_until(lambda: False, 60)',
}


@pytest.mark.parametrize('code', BLOCKING.values(), ids=BLOCKING.keys())
def test_interrupt_ends_whatever_blocks(kernel_with_node, code):
    outputs = kernel_with_node.interrupt_at(f'print("now", flush=True)\n{code}', 'now')

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert len(outputs.error['traceback']) == 1
    assert outputs.streams['stderr'] == ''
    after = kernel_with_node.run(
        'n = node.count; wait_until(lambda: node.count > n, 5); rclpy.ok()'
    )
    assert after.value == 'True'


def test_interrupt_in_the_cell_that_starts_ros_keeps_the_context(new_kernel):
    """With rclpy's own signal handlers, the interrupt would shut ROS down."""
    outputs = new_kernel.interrupt_at(
        TALKER + 'node = start(Talker); heard = listen("chatter", String); heard.wait(1)\n'
        'print("waiting", flush=True); heard.wait(10**9, timeout=60)',
        'waiting',
    )

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert new_kernel.run('rclpy.ok(), len(heard.wait(2)) >= 2').value == '(True, True)'


def test_interrupt_in_the_cell_that_calls_init_keeps_the_context(new_kernel):
    """ROS keeps running after an interrupt in a cell that calls rclpy.init() and spin()."""
    code = TALKER + 'rclpy.init()\nidle = rclpy.create_node("idle")\nprint("now", flush=True)\n'
    outputs = new_kernel.interrupt_at(f'{code}rclpy.spin(idle)', 'now')

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert (
        new_kernel.run('rclpy.ok(), rclpy.create_node("next").get_name()').value
        == "(True, 'next')"
    )


def test_interrupt_inside_a_finalizer_is_not_lost(kernel):
    """Python drops an exception in __del__, so the interrupt is raised after the finalizer."""
    kernel.run(TALKER)
    outputs = kernel.interrupt_at(
        """
import time
class Slow:
    def __del__(self):
        print('finalizing', flush=True)
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            pass
slow = Slow()
del slow
wait_until(lambda: False, 60)
""",
        'finalizing',
    )

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert outputs.streams['stderr'] == ''


def test_interrupt_while_an_error_is_shown_leaves_the_guide_in_place(kernel):
    """IPython removes a handler of errors that raises, which an interrupt can cause."""
    awkward = kernel.run(
        """
import os, signal
class Awkward(Exception):
    def _render_traceback_(self):
        os.kill(os.getpid(), signal.SIGINT)
        return ['Awkward: shown']
raise Awkward
"""
    )
    guided = kernel.run('raise KeyboardInterrupt')

    assert awkward.error['traceback'] == ['Awkward: shown']
    assert awkward.streams['stderr'] == ''
    assert 'ROS 2 and the nodes' in guided.error['traceback'][0]


def test_interrupts_anywhere_leave_no_node_behind(kernel):
    kernel.run(TALKER)
    coming_and_going = """
step = 0
while True:
    step += 1
    print(f'step {step}.', flush=True)
    start(Talker)
    start(Talker, name='other')
    heard = listen('chatter', String)
    heard.wait(1)
    stop('other')
"""
    for step in random.Random(7).choices(range(1, 6), k=15):
        outputs = kernel.interrupt_at(coming_and_going, rf'step {step}\.')
        assert outputs.error['ename'] == 'KeyboardInterrupt'

    after = kernel.run(
        'node = start(Talker); listen("chatter", String).wait(2)\n'
        'sorted({*nodes(), "_roslab"}), sorted(node.get_node_names())'
    )
    known, there = ast.literal_eval(after.value)
    assert known == there
    assert after.text + after.streams['stderr'] == ''


@pytest.mark.parametrize(
    'making',
    [
        'from rclpy.executors import Executor\nleft = Executor.__new__(Executor)',
        'from ptyprocess import PtyProcess\nleft = PtyProcess.__new__(PtyProcess)',
    ],
    ids=['executor', '!command'],
)
def test_what_an_interrupt_left_half_made_is_thrown_away_quietly(kernel, making):
    """A finalizer that fails because of a missing attribute writes nothing to stderr."""
    assert kernel.run(f'{making}; del left').streams['stderr'] == ''


def test_a_finalizer_of_ones_own_that_fails_is_shown(kernel):
    outputs = kernel.run(
        'class Own:\n  def __del__(self): return self.nothing\nleft = Own(); del left'
    )

    assert 'nothing' in outputs.streams['stderr']
