"""
Real notebook kernels end by themselves and leave nothing behind.

A kernel that Jupyter has to terminate leaves files in shared memory, which fails these tests.
"""

from contextlib import ExitStack
import os

from live_kernels import Kernel, TALKER
import psutil
import pytest

from tests.own_domain import own_domain

pytestmark = [pytest.mark.ros, pytest.mark.slow]

KERNELS = int(os.environ.get('KERNELS', '3'))
FILES = '*fastrtps*'  # LTTng, which rclpy loads, has a file there that belongs to no kernel
PATIENCE_S = 60  # the end takes 0.3 s
FAILING = """
class Failing(Talker):
    def on_timer(self):
        self.get_logger().info(str(1 / 0))

failing = start(Failing, name='failing'); wait_until(lambda: 'failing' not in nodes())
"""
INTERRUPTED = 'print("now", flush=True); wait_until(lambda: False, 60)'


@pytest.fixture
def shared_memory(tmp_path):
    """Return the folder that a kernel gets as its /dev/shm."""
    folder = tmp_path / 'shm'
    folder.mkdir()
    return folder


@pytest.mark.claim('J9')
def test_restarts_leave_nothing_behind(tmp_path, shared_memory):
    """Kernels with live nodes leave no process, no shared memory, and no node in their domain."""
    left, threads = [], set()
    with ExitStack() as until:
        domain = str(own_domain(until))
        for _ in range(KERNELS):
            kernel = Kernel(tmp_path, shared_memory=shared_memory, domain=domain)
            kernel.run(TALKER)
            kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
            assert kernel.run(FAILING).error is None
            kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')
            assert kernel.interrupt_at(INTERRUPTED, 'now').error
            family = [psutil.Process(kernel.pid)]
            family += family[0].children(recursive=True)
            threads.add(family[0].num_threads())
            assert kernel.run('nodes().keys(), node.get_node_names()').value == (
                "(dict_keys(['talker']), ['_roslab', 'talker'])"
            )
            assert list(shared_memory.glob(FILES))
            kernel.shut_down(PATIENCE_S)
            left += [process for process in family if process.is_running()]
            left += shared_memory.glob(FILES)

    assert left == []
    assert max(threads) - min(threads) <= 2  # the kernel's own pools vary by a thread


def test_kernel_with_an_endless_callback_ends_by_itself(tmp_path, shared_memory):
    kernel = Kernel(tmp_path, shared_memory=shared_memory)
    kernel.run(TALKER)
    kernel.run(
        'class Endless(Talker):\n    def on_timer(self):\n        self.count = 1\n'
        '        while True: pass'
    )
    kernel.run('node = start(Endless); wait_until(lambda: node.count)')

    kernel.shut_down(PATIENCE_S)

    assert list(shared_memory.glob(FILES)) == []
