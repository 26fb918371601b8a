"""roslab in real notebook kernels: live cells, interrupts, re-runs and the end of a kernel."""

import contextlib
import os
from pathlib import Path
import queue
import random
import re
import time

import nbformat
import pytest

jupyter_client = pytest.importorskip('jupyter_client')

from jupyter_client.kernelspec import NoSuchKernel
from nbclient import NotebookClient

pytestmark = [pytest.mark.ros, pytest.mark.slow]

KERNEL = 'ros2_jazzy'
DEADLINE_S = 120.0

TALKER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from roslab import *

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.publisher.publish(String(data=str(self.count)))
"""


class Outputs:
    """What one cell produced."""

    def __init__(self):
        self.streams = {'stdout': '', 'stderr': ''}
        self.data = []
        self.error = None

    @property
    def text(self):
        """All of stdout."""
        return self.streams['stdout']

    @property
    def value(self):
        """The text form of the cell's value or display."""
        return self.data[-1]['text/plain']


class Kernel:
    """A running kernel, its messages waited for with a deadline."""

    def __init__(self, folder):
        self.manager = jupyter_client.KernelManager(kernel_name=KERNEL)
        env = {**os.environ, 'ROS_DOMAIN_ID': str(random.randrange(1, 101))}
        self.manager.start_kernel(cwd=str(folder), env=env)
        self.client = self.manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=DEADLINE_S)
        self.other_cells = ''

    @property
    def pid(self):
        """Process id of the kernel."""
        return self.manager.provisioner.pid

    def begin(self, code, cell_id=None):
        """Send a cell without waiting for it."""
        content = {'code': code, 'silent': False, 'store_history': True, 'allow_stdin': False}
        metadata = {'cellId': cell_id} if cell_id else {}
        message = self.client.session.msg('execute_request', content, metadata=metadata)
        self.client.shell_channel.send(message)
        return message['header']['msg_id']

    def collect(self, message_id, until=None):
        """Return the cell's outputs so far: to its end, or to where stdout matches."""
        outputs, end = Outputs(), time.monotonic() + DEADLINE_S
        while True:
            try:
                message = self.client.get_iopub_msg(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f'no end of the cell; so far: {vars(outputs)}') from None
            kind, content = message['msg_type'], message['content']
            if message['parent_header'].get('msg_id') != message_id:
                self.other_cells += content.get('text', '') if kind == 'stream' else ''
                continue
            if kind == 'stream':
                outputs.streams[content['name']] += content['text']
                if until and re.search(until, outputs.text):
                    return outputs
            elif kind in ('execute_result', 'display_data', 'update_display_data'):
                outputs.data.append(content['data'])
            elif kind == 'error':
                outputs.error = content
            elif kind == 'status' and content['execution_state'] == 'idle':
                return outputs

    def run(self, code, cell_id=None):
        """Execute a cell and return what it produced."""
        return self.collect(self.begin(code, cell_id))

    def interrupt_at(self, code, marker):
        """Execute a cell and interrupt it when it has printed a marker."""
        message_id = self.begin(code)
        self.collect(message_id, until=marker)
        self.manager.interrupt_kernel()
        return self.collect(message_id)

    def shared_memory(self):
        """Return the files of the middleware in /dev/shm that the kernel has mapped."""
        maps = Path(f'/proc/{self.pid}/maps').read_text()
        return {Path(path) for path in re.findall(r'/dev/shm/\S*fastrtps\S*', maps)}

    def shut_down(self):
        """End the kernel as a frontend does and return how long it took [s]."""
        begin = time.monotonic()
        self.manager.shutdown_kernel()
        seconds = time.monotonic() - begin
        self.client.stop_channels()
        return seconds


def leaked(files):
    """Return the files that are left, without those that another process uses, too."""
    maps = []
    for process in Path('/proc').glob('[0-9]*/maps'):
        with contextlib.suppress(OSError):
            maps.append(process.read_text())
    used = '\n'.join(maps)
    return [path for path in files if path.exists() and str(path) not in used]


@pytest.fixture
def kernel(tmp_path):
    """Return a kernel that works in an empty folder."""
    try:
        kernel = Kernel(tmp_path)
    except NoSuchKernel:
        pytest.skip(f'kernel {KERNEL} is not installed: make prepare')
    yield kernel
    if kernel.manager.has_kernel:
        kernel.shut_down()


def execute(cells, folder):
    """Execute cells with nbclient, as CI does, and return the notebook."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    client = NotebookClient(
        notebook,
        kernel_name=KERNEL,
        timeout=DEADLINE_S,
        resources={'metadata': {'path': str(folder)}},
        allow_error_names=['NotImplementedError', 'NameRefusedError', 'NodeSyntaxError'],
    )
    client.execute(env={**os.environ, 'ROS_DOMAIN_ID': str(random.randrange(1, 101))})
    return notebook


def streams(cell, name='stdout'):
    """Return what a cell of an executed notebook printed."""
    return ''.join(o.text for o in cell.outputs if o.output_type == 'stream' and o.name == name)


def errors(cell):
    """Return the errors of a cell as one text each."""
    return ['\n'.join(o.traceback) for o in cell.outputs if o.output_type == 'error']


def test_notebook_with_live_cells_executes_without_stderr(tmp_path):
    """A node that one cell starts is heard by the next; a re-run replaces it."""
    begin = 'node = start(Talker); heard = listen("chatter", String)'
    notebook = execute(
        [TALKER, begin, 'print(len(heard.wait(3)) >= 3)', begin, 'heard.wait(3); list(nodes())'],
        tmp_path,
    )

    assert streams(notebook.cells[2]) == 'True\n'
    assert notebook.cells[4].outputs[-1].data['text/plain'] == "['talker']"
    assert not [cell.source for cell in notebook.cells if streams(cell, 'stderr')]


def test_node_cell_is_saved_run_and_exported(tmp_path):
    """%%node keeps the cell as a file and defines its names in the notebook."""
    body = TALKER.replace('from roslab import *', '').replace('import rclpy\n', 'import sys\n')
    notebook = execute(
        ['import roslab', f'%%node talker\n{body}', 'roslab.start(Talker); Talker.__module__'],
        tmp_path,
    )
    saved = tmp_path / 'ros_ws/src/temp_monitor_pkg/temp_monitor_pkg/talker.py'

    assert saved.read_text().strip() == body.strip()
    assert 'temp_monitor_pkg/talker.py' in streams(notebook.cells[1])
    assert 'defined Talker' in streams(notebook.cells[1])
    assert notebook.cells[2].outputs[-1].data['text/plain'] == "'talker'"


def test_bare_main_call_does_not_block_the_cell(tmp_path):
    """A file that calls main() at its end is left without that call, and says so."""
    body = 'def main():\n    import time\n    time.sleep(1e6)\n\nmain()'
    notebook = execute(['import roslab', f'%%node talker\n{body}'], tmp_path)

    assert 'Line 5 calls main()' in streams(notebook.cells[1])


@pytest.mark.parametrize(
    ('cell', 'said'),
    [
        ('%%node ../x\npass', '../x'),
        ('%%node /etc/x\npass', '/etc/x'),
        ('%%node rclpy\npass', 'another name'),
        ('%%node json\npass', 'another name'),
        ('%%node {x}\npass', '{x}'),
        ('%%node\npass', '%%node temp_publisher'),
        ('%%rosmsg temperature\nint64 x', 'capital letter'),
        ('%%rosmsg Num/../../x\nint64 x', 'letters'),
        ('%%rospkg setup.py\nx', 'package.xml'),
        ('%%node x\nx = (', "'(' was never closed"),
        ('%%node stub\n# YOUR CODE HERE\nraise NotImplementedError()', 'not written yet'),
        ('%%rosmsg Temperature\n# YOUR CODE HERE', 'not written yet'),
        ('%%rospkg package.xml\n<!-- YOUR CODE HERE -->', 'not written yet'),
        ('%%rosmsg Temperature', 'not written yet'),
    ],
)
def test_refused_cell_says_why_in_one_short_text(kernel_of_module, cell, said):
    """A wrong name or an unsolved stub is one clear error without frames, and not on stderr."""
    outputs = kernel_of_module.run(cell)

    shown = '\n'.join(outputs.error['traceback'])
    assert said in shown
    assert 'roslab/' not in shown
    assert len(shown.splitlines()) <= 4
    assert outputs.streams['stderr'] == ''


@pytest.fixture(scope='module')
def kernel_of_module(tmp_path_factory):
    """Return one kernel for cells that leave nothing behind."""
    folder = tmp_path_factory.mktemp('refused')
    try:
        kernel = Kernel(folder)
    except NoSuchKernel:
        pytest.skip(f'kernel {KERNEL} is not installed: make prepare')
    kernel.run('import roslab; x = "hidden"')
    yield kernel
    kernel.shut_down()


def test_node_does_not_hide_roslab_names(kernel):
    """A learner's own `check` stays out of the notebook, which needs roslab's."""
    kernel.run('from roslab import *; import roslab')
    outputs = kernel.run('%%node mine\ndef check():\n    return 1\ndef other():\n    return 2')

    assert "'check' was kept out" in outputs.text
    assert kernel.run('check is roslab.check, other()').value == '(True, 2)'


def test_interrupt_ends_a_wait_and_nothing_else(kernel):
    """After an interrupt ROS is up, the node goes on, and the next wait works."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker)')
    outputs = kernel.interrupt_at(
        'print("waiting", flush=True); wait_until(lambda: False, 60)', 'waiting'
    )

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    after = kernel.run('n = node.count; wait_until(lambda: node.count > n + 3, 5); rclpy.ok()')
    assert after.value == 'True'


def test_interrupt_in_the_cell_that_starts_ros_keeps_the_context(kernel):
    """With rclpy's own signal handlers this interrupt would shut ROS down."""
    outputs = kernel.interrupt_at(
        TALKER + 'node = start(Talker); heard = listen("chatter", String); heard.wait(1)\n'
        'print("waiting", flush=True); heard.wait(10**9, timeout=60)',
        'waiting',
    )

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert kernel.run('rclpy.ok(), len(heard.wait(2)) >= 2').value == '(True, True)'


def test_interrupt_inside_a_finalizer_is_not_lost(kernel):
    """Python drops an exception raised in __del__; the interrupt comes when that is over."""
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


def test_interrupts_anywhere_leave_no_node_behind(kernel):
    """Interrupted while nodes come and go, the kernel knows every node that there is."""
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
        'sorted({*nodes(), "_roslab"}) == sorted(node.get_node_names())'
    )
    assert after.value == 'True'
    assert after.text + after.streams['stderr'] == ''


def test_stub_in_a_constructor_is_shown_without_frames_of_roslab(kernel):
    """The first thing a learner sees goes wrong: their own line, and what to do about it."""
    kernel.run('from roslab import *; from rclpy.node import Node')
    stub = 'class Mine(Node):\n    def __init__(self):\n        raise NotImplementedError()\n'
    outputs = kernel.run(f'{stub}start(Mine)')
    shown = '\n'.join(outputs.error['traceback'])

    assert outputs.error['ename'] == 'NotImplementedError'
    assert 'start(Mine) made no node' in shown
    assert re.search(r'Cell In\[\d+\], line 3, in __init__', shown)
    assert 'Replace that line' in shown
    assert 'session.py' not in shown


def test_callback_exception_is_printed_with_the_cell_line(kernel):
    """The learner sees the node, the cell and the line; other nodes go on."""
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
    """In a frontend the traceback goes to the node's own cell, not to the one that runs."""
    kernel.run(TALKER)
    kernel.run('go = False\nclass Bad(Talker):\n    def on_timer(self):\n        if go: 1 / 0')
    kernel.run('node = start(Bad, name="bad")', cell_id='first')
    outputs = kernel.run('go = True; wait_until(lambda: "bad" not in nodes())', cell_id='second')
    kernel.run('1')

    assert 'bad stopped' not in outputs.text
    assert 'bad stopped' in kernel.other_cells


def test_log_line_arrives_on_stdout(kernel):
    """A line of a node's logger is no error output."""
    kernel.run(TALKER)
    outputs = kernel.run('start(Talker).get_logger().warning("hot"); logs().messages')

    assert outputs.value == "['hot']"
    message_id = kernel.begin('nodes()["talker"].get_logger().error("hotter"); 1')
    assert kernel.collect(message_id).streams['stderr'] == ''


def test_kernel_with_live_nodes_ends_soon_and_leaves_no_shared_memory(kernel):
    """The end of a kernel destroys its nodes: no files of its own stay in /dev/shm."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
    files = kernel.shared_memory()
    seconds = kernel.shut_down()

    assert files
    assert seconds < 2.0
    assert leaked(files) == []


def test_kernel_with_an_endless_callback_ends_soon(kernel):
    """Not even a callback that never returns holds up a restart."""
    kernel.run(TALKER)
    kernel.run(
        'class Endless(Talker):\n    def on_timer(self):\n        self.count = 1\n'
        '        while True: pass'
    )
    kernel.run('node = start(Endless); wait_until(lambda: node.count)')
    files = kernel.shared_memory()

    assert kernel.shut_down() < 5.0
    assert leaked(files) == []


def test_rclpy_shutdown_in_a_cell_can_be_followed_by_a_start(kernel):
    """The chapter's shutdown cell does not cost the kernel."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker); rclpy.shutdown()')
    outputs = kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')

    assert outputs.error is None
    assert outputs.value == 'True'


def test_check_without_saved_files_says_what_to_run(kernel):
    """check() before the exercise's cells is one clear sentence."""
    kernel.run('from roslab import check')
    outputs = kernel.run("report = check('temperature_publisher')")

    assert 'run the cells of the exercise first' in outputs.text
    assert outputs.error is None
    assert kernel.run('bool(report)').value == 'False'


def test_check_is_shown_once_as_html_in_a_frontend(kernel):
    """A frontend gets one table, not a second copy as the cell's value."""
    kernel.run('from roslab import check')
    outputs = kernel.run("report = check('temperature_publisher')\nreport", cell_id='a')
    again = kernel.run('report', cell_id='b')

    assert len(outputs.data) == 1
    assert '<strong>' in outputs.data[0]['text/html']
    assert len(again.data) == 1
    assert outputs.text == ''
