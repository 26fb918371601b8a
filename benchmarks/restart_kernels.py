"""
Start and end kernels repeatedly, to find out whether they leave anything behind.

Each kernel runs the cells of a small lesson: a node that logs, a listener, a node that fails, an
interrupted wait.  Then it is shut down as by *Restart & Run All*, while its nodes are running.
Afterwards the program looks for processes, for files of the middleware in ``/dev/shm`` and for
nodes in the graph.  Threads are counted inside the kernel, because they end with it.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

from jupyter_client.manager import KernelManager
import psutil
import rclpy
from rclpy.context import Context
from rclpy.node import Node

from benchmarks import report

FULL_TIMES = 100
KERNEL = 'ros2_jazzy'
PATIENCE_S = 60.0
DOMAIN = 90
BIND = 'mount --bind "$0" /dev/shm && exec "$@"'
# The middleware never removes the files of a port that a killed process has opened.  So each
# kernel gets a separate /dev/shm, to see what it leaves.  The kernel keeps the process id of the
# shell.
OWN_SHARED_MEMORY = ['unshare', '--map-root-user', '--mount', 'sh', '-c', BIND]
CELLS = (
    """
from rclpy.node import Node
from roslab import *
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.publisher.publish(String(data=str(self.count)))
        self.get_logger().info(str(self.count))

class Failing(Talker):
    def on_timer(self):
        1 / 0
""",
    'talker = start(Talker); heard = listen("chatter", String); assert heard.wait(3)',
    'failing = start(Failing, name="failing"); wait_until(lambda: "failing" not in nodes())',
    'talker = start(Talker); wait_until(lambda: talker.count > 3)',
)


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if anything was left behind
    """
    parser = argparse.ArgumentParser(description=(__doc__ or '').strip().splitlines()[0])
    parser.add_argument('--times', type=int, default=FULL_TIMES, help='kernels (default 100)')
    times = parser.parse_args().times
    os.environ['ROS_DOMAIN_ID'] = str(DOMAIN)
    facts = report.machine()
    rounds = [_one_kernel(number) for number in range(times)]
    left = {
        'processes': sum(item['processes'] for item in rounds),
        'shared memory files': sum(item['shared_memory'] for item in rounds),
        'nodes in the graph': _nodes_in_the_graph(),
    }
    figures = {
        'kernels': len(rounds),
        'left_behind': left,
        'threads_in_a_kernel': sorted({item['threads'] for item in rounds}),
        'kernel_s': report.spread([item['seconds'] for item in rounds]),
        'end_s': report.spread([item['end_seconds'] for item in rounds]),
    }
    report.save('restart_kernels', facts, figures, full=times >= FULL_TIMES)
    return 1 if any(left.values()) else 0


def _one_kernel(number: int) -> dict[str, Any]:
    """Run the cells in a new kernel, end it, and count what it leaves behind."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='restart_') as folder:
        shared_memory = Path(folder, 'shm')
        shared_memory.mkdir()
        manager = KernelManager(kernel_name=KERNEL)
        spec = manager.kernel_spec
        assert spec is not None  # the set-up has registered the kernel
        spec.argv = [*OWN_SHARED_MEMORY, str(shared_memory), *spec.argv]
        manager.start_kernel(cwd=folder)
        client = manager.client()
        client.start_channels()
        try:
            client.wait_for_ready(timeout=PATIENCE_S)
            for cell in CELLS:
                _run(client, cell)
            _interrupted(manager, client)
            assert manager.provisioner is not None  # exists since the kernel was started
            kernel = psutil.Process(manager.provisioner.pid)  # type: ignore[attr-defined]
            family = [kernel, *kernel.children(recursive=True)]
            threads = kernel.num_threads()
        finally:
            client.stop_channels()
            ending = time.monotonic()
            manager.shutdown_kernel()
        ended = time.monotonic()
        files = len(list(shared_memory.glob('*fastrtps*')))
    left = {
        'processes': sum(process.is_running() for process in family),
        'shared_memory': files,
        'threads': threads,
        'seconds': ended - began,
        'end_seconds': ended - ending,
    }
    print(f'kernel {number + 1}:', left, flush=True)
    return left


def _run(client: Any, cell: str) -> None:
    reply = client.execute_interactive(
        cell, timeout=PATIENCE_S, allow_stdin=False, output_hook=lambda _: None
    )
    if reply['content']['status'] != 'ok':
        raise RuntimeError(f'{reply["content"]["ename"]}: {reply["content"]["evalue"]}')


def _interrupted(manager: Any, client: Any) -> None:
    """Interrupt a wait as a learner would."""
    client.execute('print("now", flush=True); wait_until(lambda: False, 60)')
    ended = False
    while True:
        message = client.get_iopub_msg(timeout=PATIENCE_S)
        if message['content'].get('text', '').startswith('now'):
            manager.interrupt_kernel()
        elif message['content'].get('ename') == 'KeyboardInterrupt':
            ended = True
        elif ended and message['content'].get('execution_state') == 'idle':
            return


def _nodes_in_the_graph() -> int:
    """Return how many nodes a new participant discovers, excluding itself."""
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    try:
        node = Node('newcomer', context=context)
        end = time.monotonic() + 1.0  # long enough to discover existing nodes
        found: Sequence[str] = ()
        while time.monotonic() < end:
            time.sleep(0.05)
            found = node.get_node_names()
        node.destroy_node()
        return len(found) - 1
    finally:
        context.try_shutdown()


if __name__ == '__main__':
    sys.exit(main())
