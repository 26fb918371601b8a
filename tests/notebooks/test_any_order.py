"""
Run cells in any order, and interrupt kernels at any moment.

Each lesson runs in one kernel, in random sequences of neighbouring cells.  Some cells are
interrupted after a random time, and every cell after ``ANY_ORDER_IMPATIENCE_S`` (default 4).
After each cell the kernel must respond, ROS must run, and the outcome must help a learner.
``ANY_ORDER_RUNS`` is the number of cells per lesson (default 8) and ``ANY_ORDER_SEED`` the seed,
which a failure prints.
"""

from collections import Counter
import contextlib
import os
from pathlib import Path
import queue
import random
import shutil
import time

import nbformat
import pytest

jupyter_client = pytest.importorskip('jupyter_client')

from jupyter_client.kernelspec import NoSuchKernel

from autograder.layout import lesson_files
from tests.own_domain import own_domain

ROOT = Path(__file__).resolve().parents[2]
LESSONS = lesson_files(ROOT / 'solutions')
KERNEL = 'ros2_jazzy'

RUNS = int(os.environ.get('ANY_ORDER_RUNS', '8'))
SEED = int(os.environ.get('ANY_ORDER_SEED', '20240517'))
IN_ORDER = 0.6
"""Share of the cells that are followed by the next one, as learners usually do."""
INTERRUPTED = 0.4
"""Share of the cells that are interrupted early, if they are still running."""
LATEST_INTERRUPT_S = 1.0
IMPATIENCE_S = float(os.environ.get('ANY_ORDER_IMPATIENCE_S', '4'))
"""Limit for the other cells [s]: out of order, some wait for messages that never arrive."""
PATIENCE_S = 90.0
PATIENCE_AFTER_INTERRUPT_S = 60.0
SENTENCES = ('RoslabError', 'NotHereError', 'NameRefusedError', 'TimeoutError', 'NodeSyntaxError')
PLAIN = ('KeyboardInterrupt', 'NotImplementedError')

pytestmark = [pytest.mark.ros, pytest.mark.notebooks, pytest.mark.slow]


class Lesson:
    """A kernel in a folder with a copy of one lesson."""

    def __init__(self, path, folder):
        shutil.copy(path, folder)
        cells = nbformat.read(path, as_version=4).cells
        self.cells = [cell for cell in cells if cell.cell_type == 'code' and cell.source.strip()]
        self.manager = jupyter_client.KernelManager(kernel_name=KERNEL)
        self.until = contextlib.ExitStack()
        env = {**os.environ, 'ROS_DOMAIN_ID': str(own_domain(self.until))}
        env.pop('PYTEST_CURRENT_TEST', None)  # with it, ipykernel would not read its own stdout
        self.manager.start_kernel(cwd=str(folder), env=env)
        self.client = self.manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=PATIENCE_S)

    def run(self, code, interrupt_after_s=None):
        """Run code and return the error message that ended it, None if there was none."""
        message_id = self.client.execute(code)
        error, begin = None, time.monotonic()
        patience = PATIENCE_S
        while True:
            left = begin + patience - time.monotonic()
            if interrupt_after_s is not None:
                left = begin + interrupt_after_s - time.monotonic()
            try:
                message = self.client.get_iopub_msg(timeout=max(0.0, left))
            except queue.Empty:
                if interrupt_after_s is None:
                    raise AssertionError(f'no end of {code!r} in {patience} s') from None
                self.manager.interrupt_kernel()
                begin, patience = time.monotonic(), PATIENCE_AFTER_INTERRUPT_S
                interrupt_after_s = None
                continue
            if message['parent_header'].get('msg_id') != message_id:
                continue
            if message['msg_type'] == 'error':
                error = message['content']
            elif message['content'].get('execution_state') == 'idle':
                return error

    def value(self, code):
        """Return the text form of an expression."""
        reply = self.client.execute_interactive(
            '', user_expressions={'it': code}, timeout=PATIENCE_AFTER_INTERRUPT_S, silent=True
        )['content']
        return reply['user_expressions']['it'].get('data', {}).get('text/plain')


@pytest.fixture
def lesson(request, tmp_path):
    """Return the running lesson, ended afterwards."""
    try:
        lesson = Lesson(request.param, tmp_path)
    except NoSuchKernel:
        pytest.skip(f'kernel {KERNEL} is not installed: make prepare')
    yield lesson
    lesson.client.stop_channels()
    with contextlib.suppress(RuntimeError):
        lesson.manager.shutdown_kernel()
    lesson.until.close()


def outcome(error):
    """Return a short name of a cell's outcome, None if the outcome does not help a learner."""
    if error is None:
        return 'ran'
    name, shown = error['ename'], error['traceback']
    if shown[0].startswith('KeyboardInterrupt: '):
        return 'KeyboardInterrupt'
    if name in PLAIN:
        return name
    if name in SENTENCES and len(shown) == 1:
        return 'one sentence'
    if 'Run first: ' in shown[-1]:
        return 'which cell to run first' if len(shown) == 1 else 'error and what to run first'
    return None


@pytest.mark.parametrize('lesson', LESSONS, ids=lambda path: path.stem, indirect=True)
def test_any_order_of_cells_and_any_interrupt_leaves_a_kernel_that_works(lesson, record_property):
    """No cell hangs, ends the kernel or gives an error without advice."""
    dice, seen = random.Random(SEED), Counter()
    number = -1
    for step in range(RUNS):
        in_order = dice.random() < IN_ORDER and number + 1 < len(lesson.cells)
        number = number + 1 if in_order else dice.randrange(len(lesson.cells))
        cell = lesson.cells[number]
        early = dice.random() < INTERRUPTED
        after = dice.uniform(0, LATEST_INTERRUPT_S) if early else IMPATIENCE_S
        where = f'seed {SEED}, step {step}, cell {cell.id}, interrupt after {after}'
        error = lesson.run(cell.source, after)
        kind = outcome(error)

        assert kind is not None, f'{where}: {error["ename"]}: {error["evalue"]}\n' + '\n'.join(
            error['traceback']
        )
        assert lesson.value('6 * 7') == '42', where
        assert lesson.value("__import__('roslab.session').session.session().executor.alive") == (
            'True'
        ), where
        seen[kind] += 1
    record_property('outcomes', dict(seen))
    print(dict(seen))
