"""Test the course's own ros2 command with real nodes in a separate process."""

from contextlib import ExitStack
import os
from pathlib import Path
import re
import signal
import subprocess
import sys

import pytest

from environment.ros import ros_environment
from environment.ros2_command import overlaid
from tests.own_domain import own_domain

ROS2 = Path(sys.prefix) / 'bin' / 'ros2'
HERE = Path(__file__).parent
DEADLINE_S = 60

pytestmark = [
    pytest.mark.ros,
    pytest.mark.slow,
    pytest.mark.skipif(not ROS2.is_file(), reason='ROS 2 came with a ros2 of its own'),
]


def bare_shell(domain):
    """Return the variables of a terminal in which nothing was sourced."""
    return {'PATH': '/usr/bin:/bin', 'HOME': os.environ['HOME'], 'ROS_DOMAIN_ID': str(domain)}


class World:
    """Nodes in one process, and commands in another."""

    def __init__(self, *program):
        self.until = ExitStack()
        self.shell = bare_shell(own_domain(self.until))
        self.process = subprocess.Popen(
            [sys.executable, *program],
            env=overlaid(self.shell, ros_environment()),
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.line() == 'ready'

    def line(self):
        """Return the next line that the nodes print; ROS logs on the same stream."""
        lines = (line for line in self.process.stdout if '[WARN]' not in line)
        return next(lines).strip()

    def ros2(self, *arguments, code=0):
        """Run a command to its end and return its output, with stderr after stdout."""
        done = subprocess.run(
            [ROS2, *arguments],
            env=self.shell,
            capture_output=True,
            text=True,
            timeout=DEADLINE_S,
        )
        assert done.returncode == code, done
        assert 'Traceback' not in done.stderr
        return done.stdout + done.stderr

    def begin(self, *arguments):
        """Start a command that continues until it is stopped."""
        pipe = subprocess.PIPE
        return subprocess.Popen(
            [ROS2, *arguments], env=self.shell, stdout=pipe, stderr=pipe, text=True
        )


@pytest.fixture(scope='module')
def world():
    """Provide nodes; they end with the module."""
    world = World(HERE / 'ros2_command_world.py')
    yield world
    world.process.send_signal(signal.SIGINT)
    world.process.communicate(timeout=DEADLINE_S)
    world.until.close()
    assert world.process.returncode == 0


SILENT = """
import rclpy
from rclpy.lifecycle import LifecycleNode
rclpy.init()
silent, answering = LifecycleNode('asleep'), LifecycleNode('awake')
print('ready', flush=True)
rclpy.spin(answering)
"""
TOPICS = """\
/asked [std_msgs/msg/Int32]
/beacon/transition_event [lifecycle_msgs/msg/TransitionEvent]
/chatter [std_msgs/msg/String]
/lab/kept [std_msgs/msg/String]
/lab/said [std_msgs/msg/Int32]
/parameter_events [rcl_interfaces/msg/ParameterEvent]
/rosout [rcl_interfaces/msg/Log]
/stamped [std_msgs/msg/Header]
"""


@pytest.mark.claim('N10')
def test_topic_list_names_topics_types_and_counts(world):
    """Hidden topics are counted only on request."""
    assert world.ros2('topic', 'list', '-t') == TOPICS
    assert world.ros2('topic', 'list', '-c', '--include-hidden-topics') == '9\n'
    assert world.ros2('topic', 'type', '/chatter') == 'std_msgs/msg/String\n'


def test_topic_list_verbose_has_a_block_for_each_side(world):
    """Endpoints are counted; the command's own node also publishes on the last two topics."""
    lines = world.ros2('topic', 'list', '-v').split('\n')

    assert lines[0] == 'Published topics:'
    assert ' * /chatter [std_msgs/msg/String] 1 publisher' in lines
    assert ' * /rosout [rcl_interfaces/msg/Log] 5 publishers' in lines
    assert lines[-6:] == [
        '',
        'Subscribed topics:',
        ' * /asked [std_msgs/msg/Int32] 1 subscriber',
        ' * /chatter [std_msgs/msg/String] 1 subscriber',
        '',
        '',
    ]


INFO = """\
Type: std_msgs/msg/String

Publisher count: 1

Node name: listener
Node namespace: /lab
Topic type: std_msgs/msg/String
Topic type hash: RIHS01_{hash}
Endpoint type: PUBLISHER
GID: {gid}
QoS profile:
  Reliability: RELIABLE
  History (Depth): UNKNOWN
  Durability: TRANSIENT_LOCAL
  Lifespan: Infinite
  Deadline: Infinite
  Liveliness: AUTOMATIC
  Liveliness lease duration: Infinite

Subscription count: 0

"""


@pytest.mark.claim('N10')
def test_topic_info_tells_each_endpoint(world):
    """The verbose output shows QoS as discovered; an unknown topic is an error."""
    text = world.ros2('topic', 'info', '-v', '/lab/kept')
    text = re.sub(r'RIHS01_[0-9a-f]{64}', 'RIHS01_{hash}', text)

    assert re.sub(r'GID: ([0-9a-f]{2}\.){15}[0-9a-f]{2}', 'GID: {gid}', text) == INFO
    assert world.ros2('topic', 'info', '/chatter') == (
        'Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 1\n'
    )
    assert world.ros2('topic', 'info', '/nope', code=1) == "Unknown topic '/nope'\n"


@pytest.mark.claim('N10')
def test_topic_echo_prints_yaml_parts_and_lines(world):
    """The command adopts the publisher's QoS, so a stored message arrives even late."""
    kept = world.ros2('topic', 'echo', '--once', '/lab/kept')

    assert kept == 'data: said before you came\n---\n'
    assert world.ros2('topic', 'echo', '--once', '--field', 'data', '/chatter') == 'hello\n---\n'
    line = world.ros2('topic', 'echo', '--once', '--csv', '/stamped')
    assert re.fullmatch(r'\d+,\d+,map\n', line)
    flow = world.ros2('topic', 'echo', '--once', '--flow-style', '/chatter', 'std_msgs/String')
    assert flow == '{data: hello}\n---\n'


def test_topic_echo_says_why_there_is_nothing(world):
    """Unknown topics, unknown fields and refused QoS give different errors; silence times out."""
    unknown = world.ros2('topic', 'echo', '/nope', code=1)
    field = world.ros2('topic', 'echo', '--once', '--field', 'nope', '/chatter', code=1)
    kept = world.begin('topic', 'echo', '/chatter', '--qos-durability', 'transient_local')

    assert unknown == (
        'WARNING: topic [/nope] does not appear to be published yet\n'
        'Could not determine the type for the passed topic\n'
    )
    assert field == "Invalid field 'nope': the message has no field 'nope'\n"
    assert world.ros2('topic', 'echo', '--timeout', '0.5', '/lab/said') == ''
    assert 'incompatible policy: DURABILITY' in kept.stdout.readline()
    kept.send_signal(signal.SIGINT)
    assert kept.communicate(timeout=DEADLINE_S) == ('', '')


def test_topic_pub_waits_for_a_subscription_and_is_heard(world):
    """The typed message arrives, even if the command ends immediately."""
    once = world.ros2('topic', 'pub', '-1', '/asked', 'std_msgs/msg/Int32', 'data: 7')

    assert world.line() == 'asked 7'
    assert once.endswith(
        'publisher: beginning loop\npublishing #1: std_msgs.msg.Int32(data=7)\n\n'
    )
    command = ('topic', 'pub', '-t', '2', '-r', '20', '-p', '2', '/asked', 'std_msgs/Int32')
    twice = world.ros2(*command, '{data: 8}')
    assert [world.line(), world.line()] == ['asked 8', 'asked 8']
    assert re.findall(r'#\d', twice) == ['#2']


def test_topic_pub_explains_what_it_cannot_send(world):
    """A wrong type, field or value fails with one line; so does a wait without a subscriber."""
    pub = ('topic', 'pub', '-1', '/nobody')
    wrong = {
        ('std_msgs/msg/Strin', 'data: x'): 'The passed message type is invalid\n',
        (
            'std_msgs/msg/Int32',
            'dat: 1',
        ): "Failed to populate field: 'Int32' object has no attribute 'dat'\n",
        (
            'std_msgs/msg/Int32',
            'seven',
        ): 'The passed value needs to be a dictionary in YAML format\n',
    }

    for arguments, words in wrong.items():
        assert world.ros2(*pub, *arguments, code=1) == words
    waited = world.ros2(*pub, 'std_msgs/msg/Empty', '--max-wait-time-secs', '0.2', code=1)
    assert 'Expected 1 subscribers but only got 0 subscribers' in waited


@pytest.mark.claim('N10')
def test_topic_hz_measures_until_ctrl_c(world):
    """A rate is printed once a second; Ctrl-C ends it without a traceback."""
    process = world.begin('topic', 'hz', '/chatter')
    rate, spread = process.stdout.readline(), process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=DEADLINE_S)

    # 20 Hz, if both programs get enough CPU time.
    assert 2 < float(re.fullmatch(r'average rate: (\d+\.\d{3})\n', rate)[1]) < 30
    assert re.fullmatch(r'\tmin: .*s max: .*s std dev: .*s window: \d+\n', spread)
    assert (process.returncode, errors) == (2, '')


def test_closed_pipe_ends_the_command_quietly(world):
    """`ros2 topic echo /chatter | head -1` leaves no traceback and no process."""
    process = world.begin('topic', 'echo', '/chatter')
    assert process.stdout.readline() == 'data: hello\n'
    process.stdout.close()

    with process.stderr as errors:
        assert errors.read() == ''
    assert process.wait(timeout=DEADLINE_S) == 0


@pytest.mark.claim('N10')
def test_node_list_and_info_show_the_graph(world):
    """Nodes are sorted, hidden ones only with -a; the sections are all there."""
    assert world.ros2('node', 'list') == '/beacon\n/lab/listener\n/talker\n'
    assert '/_shy\n' in world.ros2('node', 'list', '-a')
    text = world.ros2('node', 'info', '/lab/listener')
    assert text.startswith(
        '/lab/listener\n  Subscribers:\n    /asked: std_msgs/msg/Int32\n'
        '    /chatter: std_msgs/msg/String\n  Publishers:\n    /lab/kept: std_msgs/msg/String\n'
    )
    assert text.endswith('  Service Clients:\n\n  Action Servers:\n\n  Action Clients:\n\n')
    assert world.ros2('node', 'info', '/nope', code=1) == "Unable to find node '/nope'\n"


def test_param_reads_values_and_types(world):
    """The command prints names, values and types as the node declared them."""
    assert world.ros2('param', 'list', '/talker', '--param-type').splitlines()[:2] == [
        '  arm.names (type: string array)',
        '  rate_hz (type: double)',
    ]
    assert world.ros2('param', 'get', '/talker', 'arm.names') == (
        "String values are: ['left', 'right']\n"
    )
    assert world.ros2('param', 'get', '/talker', 'nope', code=1) == 'Parameter not set\n'
    assert world.ros2('param', 'get', '/nope', 'x', code=1) == 'Node not found\n'


def test_param_sets_and_loads_values(world, tmp_path):
    """A refusal is reported with the node's reason; a file can be loaded."""
    refused = world.ros2('param', 'set', '/talker', 'rate_hz', '3.0')
    file = tmp_path / 'talker.yaml'

    assert refused == 'Setting parameter failed: not three\n'
    assert world.ros2('param', 'set', '/talker', 'rate_hz', '5.5') == 'Set parameter successful\n'
    file.write_text('/talker:\n  ros__parameters:\n    rate_hz: 2.0\n')
    loaded = world.ros2('param', 'load', '/talker', str(file))
    assert loaded == 'Set parameter rate_hz successful\n'
    assert world.ros2('param', 'get', '--hide-type', 'talker', 'rate_hz') == '2.0\n'


def test_lifecycle_walks_through_states(world):
    """States and transitions have numbers; a refused transition is reported."""
    assert world.ros2('lifecycle', 'nodes') == '/beacon\n'
    assert world.ros2('lifecycle', 'get') == '/beacon: unconfigured [1]\n'
    assert world.ros2('lifecycle', 'list', '/beacon').startswith(
        '- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n- shutdown [5]\n'
    )
    assert world.ros2('lifecycle', 'set', '/beacon', 'fly', code=1) == (
        'Unknown transition requested, available ones are:\n- configure [1]\n- shutdown [5]\n'
    )
    assert world.ros2('lifecycle', 'set', '/beacon', '1') == 'Transitioning successful\n'
    assert world.ros2('lifecycle', 'set', '/beacon', 'activate') == 'Transitioning failed\n'
    assert world.ros2('lifecycle', 'get', '/beacon') == 'inactive [2]\n'


def test_lifecycle_get_continues_after_a_silent_node():
    """A node that is not spun is named on stderr; the states of the others are printed."""
    # Nodes of one process are discovered together, so the list is complete on a busy machine, too.
    nodes = World('-c', SILENT)
    with nodes.process, nodes.until:
        nodes.until.callback(nodes.process.kill)
        said = nodes.ros2('lifecycle', 'get')
    assert said.startswith('/awake: unconfigured [1]\n')
    assert "Exception while calling service of node '/asleep': /asleep/get_state did not" in said


def test_interface_verbs_need_no_nodes(world):
    """Definitions show nested types one tab deeper."""
    header = world.ros2('interface', 'show', '--no-comments', 'std_msgs/msg/Header')

    assert header == (
        'builtin_interfaces/Time stamp\n\tint32 sec\n\tuint32 nanosec\nstring frame_id\n'
    )
    assert 'std_msgs/msg/String\n' in world.ros2('interface', 'package', 'std_msgs')
    assert world.ros2('interface', 'list', '-m').startswith('Messages:\n    ')
    assert world.ros2('interface', 'show', 'nope/msg/X', code=1) == "Unknown package 'nope'\n"


def test_pkg_verbs_find_the_courses_package(world):
    """The course's workspace is found in a terminal without sourcing."""
    prefix = ros_environment().workspace

    assert world.ros2('pkg', 'prefix', 'temp_monitor_pkg') == f'{prefix}\n'
    assert 'temp_monitor_pkg temp_publisher\n' in world.ros2('pkg', 'executables')
    assert world.ros2('pkg', 'prefix', 'nope', code=1) == 'Package not found\n'
    assert world.ros2('run', 'nope', 'x', code=1) == "Package 'nope' not found\n"
    assert world.ros2('run', 'temp_monitor_pkg', 'x', code=1) == 'No executable found\n'


def test_nobody_there_is_a_short_list_and_no_error():
    """In an empty domain, only the two topics of the command's own node are listed."""
    alone = World.__new__(World)
    alone.shell = bare_shell(101)

    assert alone.ros2('topic', 'list') == '/parameter_events\n/rosout\n'


def test_created_packages_build_and_run(world, tmp_path):
    """Both kinds of package build without changes and without messages about dependencies."""
    source = tmp_path / 'src'
    source.mkdir()
    options = ('--destination-directory', str(source), '--dependencies', 'std_msgs')
    ros = ros_environment()

    said = world.ros2('pkg', 'create', 'speaks_cpp', '--node-name', 'speak', *options)
    assert f'creating {source}/speaks_cpp/CMakeLists.txt\n' in said
    kind = ('--build-type', 'ament_python', '--license', 'Apache-2.0', '--node-name', 'speak')
    world.ros2('pkg', 'create', 'speaks_python', *kind, *options)
    assert (source / 'speaks_python' / 'LICENSE').is_file()
    env = {**world.shell, **ros.base_variables, 'COLCON_HOME': str(tmp_path)}
    built = subprocess.run(
        ['colcon', 'build'], cwd=tmp_path, env=env, capture_output=True, text=True
    )
    assert built.returncode == 0, built.stdout + built.stderr

    shown = subprocess.run(
        f'. {tmp_path}/install/local_setup.bash && {ROS2} run speaks_cpp speak'
        f' && {ROS2} run --prefix env speaks_python speak',
        shell=True,
        executable='/bin/bash',
        env=world.shell,
        capture_output=True,
        text=True,
    )
    assert shown.stdout == 'hello world speaks_cpp package\nHi from speaks_python.\n'
    again = world.ros2('pkg', 'create', 'speaks_cpp', *options, code=1)
    assert 'The directory already exists' in again


def test_run_hands_signals_and_codes_to_the_program(world):
    """The program replaces the command, so Ctrl-C ends the node itself."""
    node = world.begin('run', 'temp_monitor_pkg', 'temp_publisher', '--ros-args', '-r', '__ns:=/x')
    while '/x/' not in world.ros2('node', 'list'):
        assert node.poll() is None, node.stderr.read()
    node.send_signal(signal.SIGINT)
    node.communicate(timeout=DEADLINE_S)

    assert node.returncode == 0


@pytest.mark.parametrize('module', ['sitecustomize', 'argparse', 'rclpy'])
def test_interrupt_during_the_imports_prints_no_traceback(world, tmp_path, module):
    """The signal ends the command at once, even while Python starts or loads the parser."""
    interrupts = 'import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n'
    (tmp_path / f'{module}.py').write_text(interrupts)
    shell = {**world.shell, 'PYTHONPATH': str(tmp_path)}
    done = subprocess.run([ROS2, 'topic', 'list'], env=shell, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, '', '')


def test_launch_starts_all_nodes_and_one_interrupt_ends_them(world, tmp_path):
    """Each line begins with the process that wrote it."""
    file = tmp_path / 'both.launch.xml'
    node = '<node pkg="temp_monitor_pkg" exec="{}" namespace="launched" output="screen"/>'
    both = ''.join(node.format(name) for name in ('temp_publisher', 'temp_subscriber'))
    file.write_text(f'<launch>{both}</launch>')
    launched = world.begin('launch', str(file))
    while 'launched.temperature_subscriber' not in (line := launched.stdout.readline()):
        assert line, launched.stderr.read()
    launched.send_signal(signal.SIGINT)
    said, _ = launched.communicate(timeout=DEADLINE_S)

    assert line.startswith('[temp_subscriber-2] ')
    assert '[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)\n' in said
    assert said.count('process has finished cleanly') == 2
    assert launched.returncode == 0
