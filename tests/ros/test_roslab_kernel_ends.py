"""The end of real notebook kernels: soon, and nothing of them stays."""

from pathlib import Path

from live_kernels import Kernel, TALKER
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

FILES = '*fastrtps*'  # LTTng, which rclpy loads, has a file there that belongs to no kernel
# It takes 0.3 s (benchmarks.restart_kernels); far from the time after which Jupyter kills.
SOON_S = 60


@pytest.fixture
def shared_memory(tmp_path):
    """Return the folder that a kernel gets as its /dev/shm."""
    folder = tmp_path / 'shm'
    folder.mkdir()
    return folder


@pytest.mark.claim('J9')
def test_kernel_with_live_nodes_ends_soon_and_leaves_no_shared_memory(tmp_path, shared_memory):
    """The end of a kernel destroys its nodes: no files of its own stay in /dev/shm."""
    kernel = Kernel(tmp_path, shared_memory=shared_memory)
    kernel.run(TALKER)
    kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
    files = list(shared_memory.glob(FILES))
    seconds = kernel.shut_down()

    assert files
    assert seconds < SOON_S
    assert list(shared_memory.glob(FILES)) == []


def test_restarts_leave_nothing_behind(tmp_path, shared_memory):
    """Five kernels, each with live nodes: no process, no shared memory, no node in the graph."""
    left, threads = [], set()
    for _ in range(5):
        kernel = Kernel(tmp_path, shared_memory=shared_memory)
        kernel.run(TALKER)
        kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
        kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')
        pid = kernel.pid
        threads.add(len(list(Path(f'/proc/{pid}/task').iterdir())))
        assert kernel.run('nodes().keys(), node.get_node_names()').value == (
            "(dict_keys(['talker']), ['_roslab', 'talker'])"
        )
        kernel.shut_down()
        left += [*Path('/proc').glob(str(pid)), *shared_memory.glob(FILES)]

    assert left == []
    assert max(threads) - min(threads) <= 2  # the kernel's own pools are a thread more or less


def test_kernel_with_an_endless_callback_ends_soon(tmp_path, shared_memory):
    """Even a callback that never returns does not delay the shutdown of the kernel."""
    kernel = Kernel(tmp_path, shared_memory=shared_memory)
    kernel.run(TALKER)
    kernel.run(
        'class Endless(Talker):\n    def on_timer(self):\n        self.count = 1\n'
        '        while True: pass'
    )
    kernel.run('node = start(Endless); wait_until(lambda: node.count)')

    assert kernel.shut_down() < SOON_S
    assert list(shared_memory.glob(FILES)) == []
