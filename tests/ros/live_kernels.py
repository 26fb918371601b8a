"""Real notebook kernels for the tests, and the outputs of their cells."""

from contextlib import contextmanager, ExitStack
import os
import queue
import re
import time

import nbformat
import pytest

jupyter_client = pytest.importorskip('jupyter_client')

from jupyter_client.kernelspec import NoSuchKernel
from nbclient import NotebookClient

from environment.install_files import KERNEL_NAME as KERNEL
from tests.own_domain import own_domain

# The middleware never removes the files of a port that a killed process has opened.  So each
# kernel gets a separate /dev/shm.  The kernel keeps the process id of the shell.
BIND = 'mount --bind "$0" /dev/shm && exec "$@"'
OWN_SHARED_MEMORY = ['unshare', '--map-root-user', '--mount', 'sh', '-c', BIND]
AS_USER = [
    *('sh', '-c'),
    'user=$1; chown "$user" "$2"; shift 2; '
    'exec setpriv --reuid "$user" --regid "$user" --clear-groups "$@"',
    'sh',
]
"""Runs a kernel as a user; the user id, the connection file and the command follow."""
DEADLINE_S = 400.0  # beyond the limit of a message build, 300 s

DRAWS = """\
from rclpy.node import Node
from roslab import *
from std_msgs.msg import Float32

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        publisher = self.create_publisher(Float32, 'level', 10)
        self.create_timer(0.1, lambda: publisher.publish(Float32(data=1.0)))
        self.create_timer(1.0, lambda: self.get_logger().info('still here'))

start(Talker)
plot('level', 'data')"""
"""A cell whose node keeps logging, and whose picture keeps drawing, after it has ended."""
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

EMPTY = """
import os, sys, roslab
roslab.stop_all()
for name in [n for n, m in sys.modules.items() if os.getcwd() in str(vars(m).get('__file__'))]:
    del sys.modules[name]
os.chdir({folder!r})
get_ipython().reset(new_session=True)
"""


def variables(until):
    """Return the variables of a kernel in a domain that is reserved until the stack is closed."""
    env = {**os.environ, 'ROS_DOMAIN_ID': str(own_domain(until))}
    env.pop('PYTEST_CURRENT_TEST', None)  # with it, ipykernel would not read its own stdout
    return env


class Outputs:
    """The outputs of one cell."""

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
    """A running kernel; every wait for its messages has a deadline."""

    def __init__(
        self, folder, *arguments, terminal=None, shared_memory=None, domain=None, user=None
    ):
        self.manager = jupyter_client.KernelManager(kernel_name=KERNEL)
        if shared_memory:
            spec = self.manager.kernel_spec
            spec.argv = [*OWN_SHARED_MEMORY, str(shared_memory), *spec.argv]
        self.until = ExitStack()
        env = variables(self.until)
        if domain is not None:  # '' leaves the choice to the kernel
            env['ROS_DOMAIN_ID'] = domain
        if user is not None:
            self.manager.connection_file = str(folder / 'kernel.json')
            spec = self.manager.kernel_spec
            spec.argv = [*AS_USER, str(user), self.manager.connection_file, *spec.argv]
            env |= {'HOME': str(folder), 'ROS_LOG_DIR': str(folder / 'log')}
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

    def begin(self, code, cell_id=None, store_history=True):
        """Send a cell without waiting for it."""
        content = {'code': code, 'silent': False, 'store_history': store_history}
        content['allow_stdin'] = False
        metadata = {'cellId': cell_id} if cell_id else {}
        message = self.client.session.msg('execute_request', content, metadata=metadata)
        self.client.shell_channel.send(message)
        return message['header']['msg_id']

    def collect(self, message_id, until=None):
        """Return the cell's outputs so far: up to its end, or to a match in stdout."""
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
        return self.collect(self.begin(code, cell_id))

    def interrupt_at(self, code, marker):
        """Execute a cell and interrupt it when it has printed a marker."""
        message_id = self.begin(code)
        self.collect(message_id, until=marker)
        self.manager.interrupt_kernel()
        return self.collect(message_id)

    def empty(self, folder):
        cell = self.begin(EMPTY.format(folder=str(folder)), store_history=False)
        assert self.collect(cell).error is None
        self.other_cells, self.blocks = '', {}

    def shut_down(self, patience_s=5.0):
        """
        End the kernel as a frontend does, which kills a kernel that does not end.

        A kernel of ipykernel 7.4 can wait forever after it has shut ROS down: its
        control thread sends a status to a thread that has just ended, and the main thread waits
        for it.

        :param patience_s: the kernel is terminated after half of it, and then killed [s]
        """
        self.manager.shutdown_wait_time = patience_s
        self.manager.shutdown_kernel()
        self.client.stop_channels()
        self.until.close()


@contextmanager
def started(folder):
    """Start a kernel, and end it afterwards."""
    try:
        kernel = Kernel(folder)
    except NoSuchKernel:
        pytest.skip(f'kernel {KERNEL} is not installed: make prepare')
    try:
        yield kernel
    finally:
        kernel.shut_down()


@pytest.fixture
def new_kernel(tmp_path):
    """Return a kernel that has just been started in an empty folder."""
    with started(tmp_path) as kernel:
        yield kernel


@pytest.fixture(scope='module')
def kernel_to_share(tmp_path_factory):
    """Start a kernel that the tests of a module use one after another."""
    with started(tmp_path_factory.mktemp('shared')) as kernel:
        yield kernel


@pytest.fixture
def kernel(kernel_to_share, tmp_path):
    """Return a kernel without names and nodes that works in an empty folder."""
    kernel_to_share.empty(tmp_path)
    return kernel_to_share


@pytest.fixture(scope='module')
def kernel_of_module(tmp_path_factory):
    """Return one kernel for cells that leave nothing behind."""
    with started(tmp_path_factory.mktemp('refused')) as kernel:
        kernel.run('import roslab; x = "hidden"')
        yield kernel


@pytest.fixture(scope='module')
def kernel_with_node(tmp_path_factory):
    """Return one kernel in which a node runs, and another node is idle."""
    with started(tmp_path_factory.mktemp('interrupts')) as kernel:
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
    with ExitStack() as until:
        client.execute(env=variables(until))
    return notebook


def streams(cell, name='stdout'):
    """Return the printed output of a cell in an executed notebook."""
    return ''.join(o.text for o in cell.outputs if o.output_type == 'stream' and o.name == name)


def errors(cell):
    """Return the errors of a cell, one string per error."""
    return ['\n'.join(o.traceback) for o in cell.outputs if o.output_type == 'error']
