"""
Start and end kernels repeatedly, to find out whether they leave anything behind.

Each kernel runs the cells of a small lesson: a node that logs, a listener, a node that fails, an
interrupted wait.  Then the program shuts it down as *Restart & Run All* does, while its nodes run.
Afterwards it looks for processes, for files of the middleware in ``/dev/shm`` and for
nodes in the graph.  Threads are counted inside the kernel, because they end with it.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

import psutil
import rclpy
from rclpy.context import Context
from rclpy.node import Node

from benchmarks import report
from tests.ros.live_kernels import Kernel, TALKER

FULL_TIMES = 100
PATIENCE_S = 60.0
DOMAIN = 90
FAILING = """
class Failing(Talker):
    def on_timer(self):
        self.get_logger().info(str(1 / 0))
"""
CELLS = (
    TALKER + FAILING,
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
    parser.add_argument(
        '--times', type=int, default=FULL_TIMES, help='kernels in total (default: 100)'
    )
    times = parser.parse_args().times
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
        kernel = Kernel(Path(folder), shared_memory=shared_memory, domain=str(DOMAIN))
        for cell in CELLS:
            if error := kernel.run(cell).error:
                raise RuntimeError(f'{error["ename"]}: {error["evalue"]}')
        kernel.interrupt_at('print("now", flush=True); wait_until(lambda: False, 60)', 'now')
        process = psutil.Process(kernel.pid)
        family = [process, *process.children(recursive=True)]
        threads = process.num_threads()
        ending = time.monotonic()
        kernel.shut_down(PATIENCE_S)
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
