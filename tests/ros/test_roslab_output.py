"""Test in which cell of real notebook kernels the output of nodes appears, and how often."""

import re
import threading
import time
from types import SimpleNamespace

import live_kernels
from live_kernels import DEADLINE_S, execute, Kernel, streams, TALKER
import pytest

from roslab import pages
from roslab.console import ConsoleLines

pytestmark = [pytest.mark.ros, pytest.mark.slow]

kernel, kernel_to_share = live_kernels.kernel, live_kernels.kernel_to_share


def test_callback_exception_is_printed_with_the_cell_line(kernel):
    """The learner sees the node, the cell and the line, and other nodes keep running."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker, name="steady")')
    source = 'class Bad(Talker):\n    def on_timer(self):\n        return self.missing\n'
    message_id = kernel.begin(
        source + 'start(Bad, name="bad"); wait_until(lambda: "bad" not in nodes())'
    )
    outputs = kernel.collect(message_id)

    assert 'bad stopped' in outputs.text
    assert re.search(r'Cell In\[\d+\], line 3, in on_timer', outputs.text)
    assert "'Bad' object has no attribute 'missing'" in outputs.text
    assert outputs.streams['stderr'] == ''
    assert kernel.run('n = node.count; wait_until(lambda: node.count > n)').value == 'True'


def test_callback_exception_appears_beside_the_cell_that_started_the_node(kernel):
    """A frontend shows the traceback in the node's own cell, and not in the running one."""
    kernel.run(TALKER)
    kernel.run('go = False\nclass Bad(Talker):\n    def on_timer(self):\n        if go: 1 / 0')
    kernel.run('node = start(Bad, name="bad")', cell_id='first')
    outputs = kernel.run('go = True; wait_until(lambda: "bad" not in nodes())', cell_id='second')
    end = time.monotonic() + DEADLINE_S
    while 'bad stopped' not in ''.join(kernel.blocks.values()) and time.monotonic() < end:
        kernel.run('pass')  # reads the messages that arrived meanwhile

    assert 'bad stopped' not in outputs.text
    assert 'bad stopped' in ''.join(kernel.blocks.values())


LOUD = """
class Loud(Talker):
    def on_timer(self):
        super().on_timer()
        self.get_logger().warning(f'logged {self.count}')
        print('printed', self.count)
"""


@pytest.mark.claim('J3', 'J4')
def test_lines_of_a_node_stay_with_the_cell_that_started_it(tmp_path):
    start, later = (
        'node = start(Loud); n = wait_until(lambda: node.count > 1)',
        'before = node.count; n = wait_until(lambda: node.count > before + 20, 60)',
    )
    notebook = execute([TALKER + LOUD, start, later], tmp_path)
    # The last line that the cell printed may arrive separately, just after the block was created.
    (block,) = [one for one in notebook.cells[1].outputs if one.output_type == 'display_data']

    assert re.search(r'WARN.* \[talker\]: logged 1\b.*\nprinted 1\n', streams(notebook.cells[1]))
    assert streams(notebook.cells[2]) == ''
    assert max(map(int, re.findall(r'printed (\d+)', block.data['text/plain']))) >= 20
    assert re.match(r'\.\.\. \d+ more, see logs\(\)', block.data['text/plain'])
    assert len(block.data['text/plain'].splitlines()) <= 14


def test_lines_of_a_node_are_shown_once(kernel):
    """A line that rclpy writes with C code does not appear a second time."""
    kernel.run(TALKER + LOUD)
    outputs = kernel.run('node = start(Loud); wait_until(lambda: node.count > 3); stop_all()')
    logged = re.findall(r'logged (\d+)', outputs.text)

    assert len(logged) == len(set(logged)) >= 4
    assert re.findall(r'printed (\d+)', outputs.text) == logged


def test_nothing_is_written_to_the_terminal_of_the_server(tmp_path):
    """The kernel would copy the output of C code, and so every line of a node, to the terminal."""
    with (tmp_path / 'terminal.txt').open('w') as terminal:
        kernel = Kernel(tmp_path, terminal=terminal)
    kernel.run(TALKER + LOUD)
    kernel.run('node = start(Loud); wait_until(lambda: node.count > 3)')
    kernel.run('twin = rclpy.create_node("talker"); import os; os.system("echo from a child")')
    kernel.shut_down()
    written = (tmp_path / 'terminal.txt').read_text().splitlines()

    assert [line for line in written if not line.startswith('[IPKernelApp]')] == []


def test_lines_of_c_code_are_shown_like_others(kernel):
    """A warning from ROS itself is shown without the marks around it."""
    kernel.run(TALKER)
    outputs = kernel.run('stop_all(); start(Talker); twin = rclpy.create_node("talker")')

    assert re.search(r'WARN.* \[rcl.logging_rosout\]: Publisher already reg', outputs.text)
    assert '\x1e' not in outputs.text
    assert outputs.streams['stderr'] == ''


def test_line_of_c_code_does_not_get_into_the_middle_of_a_printed_one(monkeypatch):
    """`print` writes a line and its end separately, while another thread reads C code's output."""
    monkeypatch.setattr(pages, '_LINE_S', 60.0, raising=False)
    shown = []
    stream = SimpleNamespace(write=shown.append)
    both = pages.Pages(stream, ConsoleLines())
    watcher = threading.Thread(target=lambda: both.write('from C\n'), daemon=True)
    both._watcher = watcher

    both.write('from Python')
    watcher.start()
    watcher.join(0.1)
    both.write('\n')
    watcher.join(60.0)

    assert ''.join(shown) == 'from Python\nfrom C\n'


def test_log_line_arrives_on_stdout(kernel):
    kernel.run(TALKER)
    outputs = kernel.run('start(Talker).get_logger().warning("hot"); logs().messages[-1]')

    assert outputs.value == "'hot'"
    message_id = kernel.begin('nodes()["talker"].get_logger().error("hotter"); 1')
    assert kernel.collect(message_id).streams['stderr'] == ''
