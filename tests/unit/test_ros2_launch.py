"""Launch files in XML: which parts are read, and which are refused."""

import pytest

pytest.importorskip('ament_index_python')

from roslab.ros2 import launch

PACKAGE = 'my_robot_pkg'


@pytest.fixture
def installed(tmp_path, monkeypatch):
    marker = tmp_path / 'share' / 'ament_index' / 'resource_index' / 'packages' / PACKAGE
    program = tmp_path / 'lib' / PACKAGE / 'talker'
    for path in (marker, program):
        path.parent.mkdir(parents=True)
        path.touch()
    program.chmod(0o755)
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    return tmp_path


def read(folder, inside):
    """Return the programs that a launch file with these tags starts."""
    path = folder / 'a.launch.xml'
    path.write_text(f'<launch>{inside}</launch>')
    return list(launch.read(path))


def test_node_becomes_a_command_with_its_names_and_parameters(installed):
    (start,) = read(
        installed,
        """<node pkg="my_robot_pkg" exec="talker" name="crier" namespace="lab" output="screen">
          <remap from="chatter" to="news"/>
          <param name="rate" value="2.0"/>
          <param from="$(find-pkg-share my_robot_pkg)/config/a.yaml"/>
        </node>""",
    )

    program, mark, *rest = start.command
    assert (program, mark) == (str(installed / 'lib' / PACKAGE / 'talker'), '--ros-args')
    assert rest[:6] == ['-r', '__node:=crier', '-r', '__ns:=/lab', '-r', 'chatter:=news']
    assert rest[6:8] == ['-p', 'rate:=2.0']
    assert rest[8:] == ['--params-file', f'{installed}/share/{PACKAGE}/config/a.yaml']
    assert (start.name, start.screen) == ('talker-1', True)


def test_bare_node_starts_without_arguments(installed):
    """The output of the node is not shown, as with the real command."""
    (start,) = read(installed, '<node pkg="my_robot_pkg" exec="talker"/>')

    assert (len(start.command), start.screen) == (1, False)


@pytest.mark.parametrize(
    ('inside', 'said'),
    [
        ('<node pkg="nobody" exec="talker"/>', "Package 'nobody' not found"),
        ('<node pkg="my_robot_pkg" exec="x"/>', "executable 'x' not found in the package"),
        ('<arg name="a"/>', '<arg> belongs to a full installation'),
        ('<node pkg="my_robot_pkg" exec="talker" if="1"/>', '<node if> belongs to a full'),
        ('<node', 'reads only XML launch files'),
    ],
)
def test_launch_file_refused_says_why(installed, inside, said):
    with pytest.raises(RuntimeError, match=said):
        read(installed, inside)


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (('nobody', 'a.launch.xml'), "Package 'nobody' not found"),
        ((PACKAGE, 'a.launch.xml'), 'was not found in the share directory'),
        (('a.launch.xml', None), "file 'a.launch.xml' was not found"),
    ],
)
def test_missing_launch_file_is_named(installed, words, said):
    with pytest.raises(RuntimeError, match=said):
        launch.find(*words)
