"""The course's ros2 command: parsing and use of its arguments, without a node."""

from argparse import ArgumentParser
import re
import signal
from xml.etree import ElementTree

import pytest

pytest.importorskip('rclpy')

from builtin_interfaces.msg import Time
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Empty, Float64MultiArray, Header, String

from environment.ros import ros_environment
from roslab.ros2 import (
    cli,
    graph,
    interface,
    pkg_files,
    qos_options,
    topic_pub,
)
from roslab.ros2.interface import definition
from roslab.ros2.topic_echo import _selected

VERBS = {
    'bag': ('info', 'play', 'record'),
    'daemon': ('start', 'status', 'stop'),
    'interface': ('list', 'package', 'show'),
    'launch': (),
    'lifecycle': ('get', 'list', 'nodes', 'set'),
    'node': ('info', 'list'),
    'param': ('get', 'list', 'load', 'set'),
    'pkg': ('create', 'executables', 'list', 'prefix'),
    'run': (),
    'topic': ('bw', 'echo', 'hz', 'info', 'list', 'pub', 'type'),
}


@pytest.mark.parametrize('group', VERBS)
def test_help_lists_every_verb_and_its_options(group, capsys):
    for verb in ((), *((verb,) for verb in VERBS[group])):
        with pytest.raises(SystemExit) as ended:
            cli.main([group, *verb, '--help'])
        assert ended.value.code == 0
        text = capsys.readouterr().out
        assert f'usage: ros2 {" ".join((group, *verb))}' in text
        if not verb:
            assert all(re.search(rf'\n    {name}\s', text) for name in VERBS[group])


def test_help_says_what_it_is(capsys):
    assert cli.main([]) == 0
    text = ' '.join(capsys.readouterr().out.split())
    assert "The course's own small ros2 command" in text
    assert 'its own ros2 command is used' in text
    assert set(VERBS) == set(cli.GROUPS)


@pytest.mark.parametrize(
    'words', ['the given context is not valid', "rcl node's context is invalid, at node.c:404"]
)
def test_command_that_a_signal_ends_prints_no_error(monkeypatch, words):
    """The error from rcl only says that the signal has shut down the context."""

    def asks_the_graph(_):
        raise RuntimeError(words)

    monkeypatch.setitem(cli._verbs, 'daemon status', (asks_the_graph, ()))

    assert cli.main(['daemon', 'status']) == signal.SIGINT


def test_group_without_verb_prints_its_help(capsys):
    assert cli.main(['topic']) == 0
    assert 'Verbs:' in capsys.readouterr().out


@pytest.mark.parametrize('words', [['topik'], ['topic', 'lst'], ['topic', 'pub', '-1', '-t', '2']])
def test_unknown_words_end_with_code_2_and_what_there_is(words, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words)

    assert ended.value.code == 2
    assert 'echo' in (text := capsys.readouterr().err) or 'topic' in text


def test_command_of_a_full_installation_is_distinguished_from_a_typing_mistake():
    words = cli.main(['action', 'a', 'b'])

    assert words.startswith('ros2 action belongs to a full installation')
    assert 'topic' in words


def test_daemon_answers_honestly(capsys):
    assert cli.main(['daemon', 'status']) is None
    assert capsys.readouterr().out.startswith('The daemon is not running')
    assert 'cannot be started' in cli.main(['daemon', 'start'])


@pytest.mark.parametrize(
    ('outcome', 'code', 'words'),
    [(None, 0, ''), (0, 0, ''), (1, 1, ''), ('Node not found', 1, 'Node not found\n')],
)
def test_outcome_of_a_verb_is_the_exit_code(outcome, code, words, monkeypatch, capsys):
    monkeypatch.setattr(cli, 'main', lambda arguments: outcome)

    with pytest.raises(SystemExit) as ended:
        cli.run_command([])
    assert (ended.value.code or 0, capsys.readouterr().err) == (code, words)


def qos_of(*words):
    parser = ArgumentParser()
    for names, how, _ in qos_options.qos_arguments('publish', 'default'):
        parser.add_argument(*names, **how)
    return qos_options.qos_asked_for(parser.parse_args(words), 'default')


def test_qos_options_change_their_profile():
    quick = qos_of('--qos-profile', 'sensor_data', '--qos-depth', '3')
    kept = qos_of('--qos-durability', 'transient_local')

    assert qos_of() is None
    assert (quick.depth, quick.reliability) == (3, ReliabilityPolicy.BEST_EFFORT)
    assert (kept.depth, kept.durability) == (10, DurabilityPolicy.TRANSIENT_LOCAL)
    assert graph.preset('default').durability == DurabilityPolicy.VOLATILE


class Graph:
    """A node that reports publishers with these QoS profiles."""

    def __init__(self, *profiles):
        self.profiles = profiles

    def get_publishers_info_by_topic(self, topic):
        return [type('Info', (), {'qos_profile': profile}) for profile in self.profiles]


RELIABLE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


@pytest.mark.parametrize(
    ('publishers', 'reliability', 'durability', 'lines'),
    [
        ((), 'BEST_EFFORT', 'VOLATILE', 0),
        ((RELIABLE,), 'RELIABLE', 'TRANSIENT_LOCAL', 0),
        ((BEST_EFFORT,), 'BEST_EFFORT', 'VOLATILE', 0),
        ((RELIABLE, BEST_EFFORT), 'BEST_EFFORT', 'VOLATILE', 2),
    ],
)
def test_qos_for_publishers_hears_all(publishers, reliability, durability, lines, capsys):
    qos = graph.qos_for_publishers(Graph(*publishers), '/x')

    assert (qos.reliability.name, qos.durability.name) == (reliability, durability)
    assert capsys.readouterr().out.count('Falling back to') == lines


def test_fill_sets_nested_fields_arrays_and_the_time():
    array, header, text, now = Float64MultiArray(), Header(), String(), Time(sec=5)
    layout = '{data: [1, 2.5], layout: {dim: [{label: x, size: 2}], data_offset: 1}}'

    topic_pub.fill(array, topic_pub.parsed(layout))
    topic_pub.fill(header, topic_pub.parsed('{stamp: now, frame_id: 7}'), now)
    topic_pub.fill(text, topic_pub.parsed('data: yes'))

    assert list(array.data) == [1.0, 2.5]
    assert (array.layout.dim[0].label, array.layout.data_offset) == ('x', 1)
    assert (header.stamp.sec, header.frame_id, text.data) == (5, '7', 'True')


@pytest.mark.parametrize('text', ['[1, 2]', 'seven', '{a: ', '5'])
def test_values_that_are_no_mapping_are_refused(text):
    with pytest.raises(RuntimeError, match='YAML'):
        topic_pub.parsed(text)


def test_fill_unknown_field_names_it():
    with pytest.raises(AttributeError, match="'Empty' object has no attribute 'x'"):
        topic_pub.fill(Empty(), {'x': 1})


def test_selected_walks_along_a_path():
    header = Header(frame_id='map')
    header.stamp.sec = 3

    assert _selected(header, 'stamp.sec') == (3, 'int32')
    assert _selected(Float64MultiArray(data=[1.0, 2.0]), 'data[1]')[0] == 2.0
    with pytest.raises(RuntimeError, match='nope'):
        _selected(header, 'stamp.nope')


PARTS = {
    'a/msg/Whole': "# Top.\n\nPart[] parts  # many\nstring NAME='#1'\nb/Other other\nint32 n 3\n",
    'a/msg/Part': '# Inner.\nfloat64 x\n',
    'b/msg/Other': 'bool yes\n',
}


@pytest.fixture
def files(tmp_path, monkeypatch):
    for name, text in PARTS.items():
        (tmp_path / name.replace('/', '-')).write_text(text)
    path = tmp_path.joinpath
    monkeypatch.setattr(interface, 'interface_file', lambda name: path(name.replace('/', '-')))


def test_definition_puts_parts_below_their_field(files):
    lines = list(definition('a/msg/Whole', 'all', 'none'))

    assert lines == [
        '# Top.',
        '',
        'Part[] parts  # many',
        '\tfloat64 x',
        "string NAME='#1'",
        'b/Other other',
        '\tbool yes',
        'int32 n 3',
    ]
    bare = list(definition('a/msg/Whole', 'none', 'none'))
    assert bare[0] == 'Part[] parts'
    assert "string NAME='#1'" in bare
    assert '\t# Inner.' in list(definition('a/msg/Whole', 'all', 'all'))


@pytest.mark.parametrize(
    ('name', 'words'),
    [
        ('std_msgs/String', 'Expected three parts'),
        ('nope/msg/X', "Unknown package 'nope'"),
        ('std_msgs/msg/Strin', 'Could not find the interface'),
    ],
)
def test_interface_names_are_explained(name, words, monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', ros_environment().variables['AMENT_PREFIX_PATH'])
    with pytest.raises((ValueError, LookupError), match=words):
        interface.interface_file(name)


def new_package(build_type, node='speak'):
    """Return a package with all characters that need quoting in XML and Python."""
    return pkg_files.NewPackage(
        name='my_pkg',
        format=3,
        description="A & B's <thing>",
        license='MIT',
        maintainer='Zoë "Z"',
        email='z@example.org',
        build_type=build_type,
        dependencies=('rclpy',),
        node=node,
    )


@pytest.mark.parametrize('build_type', ['ament_cmake', 'ament_python'])
def test_manifest_of_a_new_package_is_right(build_type):
    files = getattr(pkg_files, f'{build_type}_files')(new_package(build_type))
    root = ElementTree.fromstring(files['package.xml'])

    assert root.findtext('description') == "A & B's <thing>"
    assert root.findtext('maintainer') == 'Zoë "Z"'
    assert root.findtext('depend') == 'rclpy'
    assert root.findtext('export/build_type') == build_type


def test_python_files_compile_and_name_the_program():
    files = pkg_files.ament_python_files(new_package('ament_python'))
    for name, text in files.items():
        if name.endswith('.py'):
            compile(text, name, 'exec')

    assert "'speak = my_pkg.speak:main'" in files['setup.py']
    bare = pkg_files.ament_python_files(new_package('ament_python', node=''))
    assert "'console_scripts': []" in bare['setup.py']
    assert 'my_pkg/speak.py' not in bare


def test_pkg_create_refuses_bad_names(tmp_path):
    def created(*words):
        return cli.main(['pkg', 'create', *words, '--destination-directory', str(tmp_path)])

    assert "'My-Pkg' is not a valid package name" in created('My-Pkg')
    assert 'not a valid node name' in created('a', '--node-name', 'x y')
    assert "can't be named 'test'" in created('test', '--build-type', 'ament_python')
    assert list(tmp_path.iterdir()) == []
