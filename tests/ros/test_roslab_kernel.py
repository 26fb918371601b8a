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


def variables():
    """Return the variables of a kernel that nobody else hears."""
    env = {**os.environ, 'ROS_DOMAIN_ID': str(random.randrange(1, 101))}
    env.pop('PYTEST_CURRENT_TEST', None)  # with it, ipykernel would not read its own stdout
    return env


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
        return next(data['text/plain'] for data in reversed(self.data) if data['text/plain'])


class Kernel:
    """A running kernel, its messages waited for with a deadline."""

    def __init__(self, folder, *arguments, terminal=None):
        self.manager = jupyter_client.KernelManager(kernel_name=KERNEL)
        env = variables()
        options = {'extra_arguments': list(arguments)} if arguments else {}
        self.manager.start_kernel(
            cwd=str(folder), env=env, stdout=terminal, stderr=terminal, **options
        )
        self.client = self.manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=DEADLINE_S)
        self.other_cells = ''
        self.blocks = {}

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
                if kind in ('display_data', 'update_display_data'):
                    self.blocks[content['transient']['display_id']] = content['data']['text/plain']
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
    client.execute(env=variables())
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


def test_kernel_loads_the_guide_and_does_without(kernel, tmp_path):
    """The kernel's extension is there from its start; one that is missing stops nothing."""
    loaded = kernel.run('"roslab.guide" in get_ipython().extension_manager.loaded')
    assert loaded.value == 'True'

    without = Kernel(tmp_path, '--ext=roslab.no_such_guide')
    assert without.run('1 + 1').value == '2'
    without.shut_down()


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
    assert notebook.cells[2].outputs[0].data['text/plain'] == "'talker'"


def test_bare_main_call_does_not_block_the_cell(tmp_path):
    """A file that calls main() at its end is left without that call, and says so."""
    body = 'def main():\n    import time\n    time.sleep(1e6)\n\nmain()'
    notebook = execute(['import roslab', f'%%node talker\n{body}'], tmp_path)

    assert 'Line 6 of the cell calls main()' in streams(notebook.cells[1])


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


def test_interrupt_while_an_error_is_shown_leaves_the_guide_in_place(kernel):
    """IPython gives up a guide that raises, and an interrupt may fall into it."""
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
    end = time.monotonic() + DEADLINE_S
    while 'bad stopped' not in ''.join(kernel.blocks.values()) and time.monotonic() < end:
        kernel.run('pass')  # what came meanwhile is read with its outputs

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
    """An executed notebook keeps what a node says later below the cell that started it."""
    start, later = (
        'node = start(Loud); n = wait_until(lambda: node.count > 1)',
        ('n = wait_until(lambda: node.count > 20)'),
    )
    notebook = execute([TALKER + LOUD, start, later], tmp_path)
    # What the cell itself printed last may come by another way just after the block was begun.
    (block,) = [one for one in notebook.cells[1].outputs if one.output_type == 'display_data']

    assert re.search(r'WARN.* \[talker\]: logged 1\b.*\nprinted 1\n', streams(notebook.cells[1]))
    assert streams(notebook.cells[2]) == ''
    assert 'printed 20' in block.data['text/plain']
    assert re.match(r'\.\.\. \d+ more, see logs\(\)', block.data['text/plain'])
    assert len(block.data['text/plain'].splitlines()) <= 14


def test_lines_of_a_node_are_shown_once(kernel):
    """What rclpy sends through C code does not come back as a second line."""
    kernel.run(TALKER + LOUD)
    outputs = kernel.run('node = start(Loud); wait_until(lambda: node.count > 3); stop_all()')
    logged = re.findall(r'logged (\d+)', outputs.text)

    assert len(logged) == len(set(logged)) >= 4
    assert re.findall(r'printed (\d+)', outputs.text) == logged


def test_nothing_is_written_to_the_terminal_of_the_server(tmp_path):
    """The kernel copies there what C code prints, which would be every line of every node."""
    with (tmp_path / 'terminal.txt').open('w') as terminal:
        kernel = Kernel(tmp_path, terminal=terminal)
    kernel.run(TALKER + LOUD)
    kernel.run('node = start(Loud); wait_until(lambda: node.count > 3)')
    kernel.run('twin = rclpy.create_node("talker"); import os; os.system("echo from a child")')
    kernel.shut_down()
    written = (tmp_path / 'terminal.txt').read_text().splitlines()

    assert [line for line in written if not line.startswith('[IPKernelApp]')] == []


def test_lines_of_c_code_are_shown_like_others(kernel):
    """A warning that ROS itself writes reaches the cell without the marks around it."""
    kernel.run(TALKER)
    outputs = kernel.run('stop_all(); start(Talker); twin = rclpy.create_node("talker")')

    assert re.search(r'WARN.* \[rcl.logging_rosout\]: Publisher already reg', outputs.text)
    assert '\x1e' not in outputs.text
    assert outputs.streams['stderr'] == ''


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
    # Python drops what is raised there.
    'a callback of a weak reference': 'gone = ref(thing, for_a_second); del thing\n'
    'wait_until(lambda: False, 60)',
}


@pytest.mark.claim('J2')
@pytest.mark.parametrize('code', BLOCKING.values(), ids=BLOCKING.keys())
def test_interrupt_ends_whatever_blocks(kernel_with_node, code):
    """Each way to block a cell can be interrupted, also with an idle node; ROS survives it."""
    outputs = kernel_with_node.interrupt_at(f'print("now", flush=True)\n{code}', 'now')

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert len(outputs.error['traceback']) == 1
    assert outputs.streams['stderr'] == ''
    after = kernel_with_node.run(
        'n = node.count; wait_until(lambda: node.count > n, 5); rclpy.ok()'
    )
    assert after.value == 'True'


@pytest.fixture(scope='module')
def kernel_with_node(tmp_path_factory):
    """Return one kernel in which a node runs, and another node is idle."""
    try:
        kernel = Kernel(tmp_path_factory.mktemp('interrupts'))
    except NoSuchKernel:
        pytest.skip(f'kernel {KERNEL} is not installed: make prepare')
    kernel.run(
        'from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor\n'
        f'from rclpy.wait_for_message import wait_for_message\n{TALKER}'
    )
    kernel.run('node = start(Talker); idle = rclpy.create_node("idle")')
    kernel.run(
        'from time import monotonic\nfrom weakref import ref\n'
        'class Thing: pass\nthing = Thing()\n'
        'def for_a_second(_):\n  end = monotonic() + 1\n  while monotonic() < end: pass\n'
    )
    yield kernel
    kernel.shut_down()


def test_interrupt_in_the_cell_that_calls_init_keeps_the_context(kernel):
    """rclpy.init() and spin() in one cell, as in a program: ROS is still up afterwards."""
    code = TALKER + 'rclpy.init()\nidle = rclpy.create_node("idle")\nprint("now", flush=True)\n'
    outputs = kernel.interrupt_at(f'{code}rclpy.spin(idle)', 'now')

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert kernel.run('rclpy.ok(), rclpy.create_node("next").get_name()').value == "(True, 'next')"


@pytest.mark.parametrize(
    ('code', 'said'),
    [
        ('rclpy.init()', 'ROS 2 runs in this notebook already'),
        ('def main():\n    rclpy.init()\nmain()', 'ROS 2 runs in this notebook already'),
        ('rclpy.spin(node)', 'start(...) spins it in the background'),
        ('rclpy.spin_once(node)', 'start(...) spins it in the background'),
    ],
)
def test_code_of_a_program_typed_in_a_cell_is_answered_in_one_line(kernel_with_node, code, said):
    """What would start ROS twice, or take the node away, says so; the node goes on."""
    outputs = kernel_with_node.run(code)

    assert said in outputs.error['traceback'][0]
    assert len(outputs.error['traceback']) == 1
    after = kernel_with_node.run('n = node.count; wait_until(lambda: node.count > n, 5)')
    assert after.value == 'True'


def test_error_in_a_node_cell_names_the_line_of_the_cell(kernel):
    """Tracebacks count as the checks do: the magic line is line 1."""
    kernel.run('import roslab')
    kernel.run('%%node broken\ndef f():\n    return 1 / 0')
    shown = re.sub(r'\x1b\[[\d;]*m', '', '\n'.join(kernel.run('f()').error['traceback']))

    assert 'Cell In[2], line 3, in f()' in shown
    assert 'return 1/0' in shown.replace(' / ', '/')


def test_stop_all_leaves_no_node_and_no_subscription(kernel):
    """After a lesson's last cell nothing is in the graph; a listener can begin again."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
    kernel.run('stop_all(); probe = rclpy.create_node("probe")')

    assert kernel.run('probe.get_node_names()').value == "['probe']"
    assert kernel.run('heard').value.endswith('stopped>')
    kernel.run('heard.clear(); node = start(Talker)')
    assert kernel.run('len(heard.wait(2)) >= 2').value == 'True'


def test_log_line_arrives_on_stdout(kernel):
    """A line of a node's logger is no error output."""
    kernel.run(TALKER)
    outputs = kernel.run('start(Talker).get_logger().warning("hot"); logs().messages')

    assert outputs.value == "['hot']"
    message_id = kernel.begin('nodes()["talker"].get_logger().error("hotter"); 1')
    assert kernel.collect(message_id).streams['stderr'] == ''


@pytest.mark.claim('J9')
def test_kernel_with_live_nodes_ends_soon_and_leaves_no_shared_memory(kernel):
    """The end of a kernel destroys its nodes: no files of its own stay in /dev/shm."""
    kernel.run(TALKER)
    kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
    files = kernel.shared_memory()
    seconds = kernel.shut_down()

    assert files
    assert seconds < 2.0
    assert leaked(files) == []


def test_restarts_leave_nothing_behind(tmp_path):
    """Five kernels, each with live nodes: no process, no shared memory, no node in the graph."""
    left, threads = [], set()
    for _ in range(5):
        kernel = Kernel(tmp_path)
        kernel.run(TALKER)
        kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
        kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')
        files, pid = kernel.shared_memory(), kernel.pid
        threads.add(len(list(Path(f'/proc/{pid}/task').iterdir())))
        assert kernel.run('nodes().keys(), node.get_node_names()').value == (
            "(dict_keys(['talker']), ['_roslab', 'talker'])"
        )
        kernel.shut_down()
        left += [path for path in (Path(f'/proc/{pid}'), *leaked(files)) if path.exists()]

    assert left == []
    assert max(threads) - min(threads) <= 2  # the kernel's own pools are a thread more or less


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


def test_a_half_made_executor_is_thrown_away_quietly(kernel):
    """What an interrupt in the middle of Executor() leaves; other complaints are shown."""
    outputs = kernel.run(
        'from rclpy.executors import Executor\nleft = Executor.__new__(Executor); del left'
    )
    assert outputs.streams['stderr'] == ''

    outputs = kernel.run(
        'class Own:\n  def __del__(self): return self.nothing\nleft = Own(); del left'
    )
    assert 'nothing' in outputs.streams['stderr']
