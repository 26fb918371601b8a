"""
Real notebook kernels end by themselves and leave nothing behind.

A kernel that Jupyter has to terminate leaves files in shared memory, which fails these tests.
"""

from pathlib import Path

from live_kernels import Kernel, TALKER
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

FILES = '*fastrtps*'  # LTTng, which rclpy loads, has a file there that belongs to no kernel
PATIENCE_S = 60  # the end takes 0.3 s (benchmarks.restart_kernels)


@pytest.fixture
def shared_memory(tmp_path):
    """Return the folder that a kernel gets as its /dev/shm."""
    folder = tmp_path / 'shm'
    folder.mkdir()
    return folder


@pytest.mark.claim('J9')
def test_restarts_leave_nothing_behind(tmp_path, shared_memory):
    """Three kernels with live nodes leave no process, no shared memory and no node."""
    left, threads = [], set()
    for _ in range(3):
        kernel = Kernel(tmp_path, shared_memory=shared_memory)
        kernel.run(TALKER)
        kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
        kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')
        pid = kernel.pid
        threads.add(len(list(Path(f'/proc/{pid}/task').iterdir())))
        assert kernel.run('nodes().keys(), node.get_node_names()').value == (
            "(dict_keys(['talker']), ['_roslab', 'talker'])"
        )
        assert list(shared_memory.glob(FILES))
        kernel.shut_down(PATIENCE_S)
        left += [*Path('/proc').glob(str(pid)), *shared_memory.glob(FILES)]

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
