"""Run the same exams on a script, a package folder, a zip of a folder, and a notebook."""

import json
from pathlib import Path
import shutil
import zipfile

import pytest

from autograder import __main__ as command
from autograder.authoring import sample_class
from autograder.commands import OK
from autograder.commands import run as run_command
from autograder.errors import GraderError
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.sandboxes.choose import strongest
from autograder.submission.reading import UnusableUploadError

ROOT = Path(__file__).resolve().parents[2]
LAYOUT = Layout.here()
PUBLISHER = 'tests/submissions/07_temperature_monitor/pass__functions_style/temp_publisher.py'
NODE = """
import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

from {package} import values


class Thermometer(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.out = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(1.0, self.tick)
        self.count = 0

    def tick(self):
        self.count += 1
        msg = Temperature(unit='Celsius', sensor_id='temp_sensor_01')
        msg.temperature_value = values.reading(self.count)
        msg.timestamp = self.get_clock().now().to_msg()
        self.out.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Thermometer())
"""
VALUES = """
def reading(count):
    return 20.0 + count % 7
"""


MANIFEST = """<package format="3">
  <name>thermo</name>
  <version>0.1.0</version>
  <description>A thermometer.</description>
  <maintainer email="a@example.com">A</maintainer>
  <license>MIT</license>
  <exec_depend>rclpy</exec_depend>
  <export><build_type>ament_{kind}</build_type></export>
</package>
"""
SETUP = """
from setuptools import setup

setup(
    name='thermo',
    version='0.1.0',
    packages=['thermo'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/thermo']),
        ('share/thermo', ['package.xml']),
    ],
    entry_points={{'console_scripts': [{entries}]}},
)
"""
IN_LIB = """
[develop]
script_dir=$base/lib/thermo
[install]
install_scripts=$base/lib/thermo
"""
ENTRY = "'temp_publisher = thermo.temp_publisher:main'"
CMAKE = """
cmake_minimum_required(VERSION 3.16)
project(thermo)
find_package(ament_cmake REQUIRED)
find_package(ament_cmake_python REQUIRED)
ament_python_install_package(thermo)
ament_package()
"""


def python_package(folder: Path, entries: str = ENTRY, **changed: str) -> Path:
    """Write a package as ``ros2 pkg create --build-type ament_python`` makes it."""
    files = {
        'package.xml': MANIFEST.format(kind='python'),
        'setup.py': SETUP.format(entries=entries),
        'setup.cfg': IN_LIB,
        'resource/thermo': '',
    }
    return package(folder, **{**files, **changed})


def package(folder: Path, **changed: str) -> Path:
    """Write a small package that has helper modules but no build files."""
    files = {
        'package.xml': '<package format="3"><name>thermo</name></package>',
        'thermo/__init__.py': '',
        'thermo/values.py': VALUES,
        'thermo/temp_publisher.py': NODE.format(package='thermo'),
        **changed,
    }
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    return folder


class TestWhatIsMeant:
    def test_an_assignment_stands_for_its_exams(self):
        """Its name works with or without the number, and the exams have the lesson's order."""
        long = run_command.exams_named('07_temperature_monitor', LAYOUT, hidden=False)
        short = run_command.exams_named('temperature_monitor', LAYOUT, hidden=False)

        assert [exam.name for exam in short] == [
            'temperature_message',
            'temperature_publisher',
            'temperature_subscriber',
            'limit_keeper',
        ]
        assert long == short

    def test_a_name_that_is_neither_is_answered_with_a_near_one(self):
        """The suggestion makes a typo easy to fix."""
        with pytest.raises(GraderError, match='Did you mean temperature_monitor'):
            run_command.exams_named('temprature_monitor', LAYOUT, hidden=False)

    def test_a_script_is_looked_at_by_the_exam_it_is_named_for(self):
        """An assignment needs a script named for an exam; a single exam accepts any name."""
        monitor = run_command.exams_named('temperature_monitor', LAYOUT, hidden=False)
        talker = run_command.exams_named('talker', LAYOUT, hidden=False)

        (task,) = run_command.find_tasks(ROOT / PUBLISHER, monitor, LAYOUT)
        assert task.exam.name == 'temperature_publisher'
        (task,) = run_command.find_tasks(ROOT / PUBLISHER, talker, LAYOUT)
        assert list(task.files) == ['talker.py']

    def test_what_is_for_none_of_the_exams_is_said(self, tmp_path):
        (tmp_path / 'odd.py').write_text('x = 1')
        monitor = run_command.exams_named('temperature_monitor', LAYOUT, hidden=False)

        with pytest.raises(UnusableUploadError, match=r'temp_subscriber\.py, got only odd\.py'):
            run_command.find_tasks(tmp_path / 'odd.py', monitor, LAYOUT)

    @pytest.mark.parametrize('name', ['odd.ipynb', 'odd.zip', 'odd.py', 'odd'])
    def test_a_path_that_leads_nowhere_is_no_submission(self, tmp_path, name):
        """A mistake by the instructor never gives a student zero points."""
        monitor = run_command.exams_named('temperature_monitor', LAYOUT, hidden=False)

        with pytest.raises(UnusableUploadError, match='there is no such file or folder'):
            run_command.find_tasks(tmp_path / name, monitor, LAYOUT)


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
class TestRuns:
    """Real runs in the sandbox."""

    @pytest.fixture(scope='class', autouse=True)
    @classmethod
    def kept(cls, tmp_path_factory):
        """Equal files run once, so the zip of a folder needs no further run."""
        cls.recordings = tmp_path_factory.mktemp('recordings')

    def points(self, path, exam='temperature_publisher'):
        """Return the points of each visible exam, and its failed checks."""
        chosen = run_command.exams_named(exam, LAYOUT, hidden=False)
        tasks = run_command.find_tasks(path, chosen, LAYOUT)
        done = run_command.run_tasks(tasks, Engine(strongest(), self.recordings))
        return {
            result.exam: (result.points, [check.cause for check in result.failed])
            for _, result in done
        }

    @pytest.mark.parametrize('form', ['folder', 'zip'])
    def test_the_finished_package_has_full_marks(self, tmp_path, form):
        """The package is built with its own messages, and its own executables run."""
        path = ROOT / 'temp_monitor_pkg'
        if form == 'zip':
            path = Path(shutil.make_archive(str(tmp_path / 'mine'), 'zip', ROOT, path.name))

        found = self.points(path, 'temperature_monitor')

        assert found.pop('limit_keeper')[0] == 0  # this exercise is not part of the package
        assert found == {
            'temperature_message': (10, []),
            'temperature_publisher': (15, []),
            'temperature_subscriber': (15, []),
        }

    def test_a_python_package_is_built_and_its_entry_point_runs(self, tmp_path):
        """The entry point may name any module and function, and import modules of its package."""
        node = NODE.format(package='.').replace('def main()', 'def start()')
        folder = python_package(
            tmp_path / 'a',
            entries="'temp_publisher = thermo.sensor:start'",
            **{'thermo/sensor.py': node},
        )
        (folder / 'thermo' / 'temp_publisher.py').unlink()

        assert self.points(folder) == {'temperature_publisher': (15, [])}

    @pytest.mark.parametrize(
        ('cause_id', 'changed'),
        [
            ('entry_point_missing', {'entries': "'thermometer = thermo.temp_publisher:main'"}),
            ('script_folder', {'setup.cfg': ''}),
            ('entry_point_module', {'entries': "'temp_publisher = thermo.sensor:main'"}),
            ('setup_py', {'setup.py': 'from setuptools import setup\n\nsetup(name=thermo)\n'}),
            (
                'executable_not_installed',
                {
                    'package.xml': MANIFEST.format(kind='cmake'),
                    'CMakeLists.txt': CMAKE,
                },
            ),
        ],
    )
    def test_a_package_that_does_not_start_says_why(self, tmp_path, cause_id, changed):
        folder = python_package(tmp_path / 'a', **changed)
        if 'CMakeLists.txt' in changed:
            (folder / 'setup.py').unlink()

        (task,) = run_command.find_tasks(
            folder, run_command.exams_named('temperature_publisher', LAYOUT, hidden=False), LAYOUT
        )
        ((_, result),) = run_command.run_tasks([task], Engine(strongest(), tmp_path / 'kept'))

        assert result.failed[0].cause_id == cause_id
        assert result.points == 0

    @pytest.mark.parametrize('where', ['thermo', 'temp_monitor_pkg'])
    def test_modules_are_those_that_were_handed_in(self, tmp_path, where):
        """If the course's own package has the same name, its modules are not used."""
        folder = package(
            tmp_path / 'a',
            **{
                f'{where}/temp_publisher.py': NODE.format(package=where),
                f'{where}/values.py': VALUES,
                f'{where}/units.py': 'raise RuntimeError("nobody asked for me")',
            },
        )
        if where != 'thermo':
            shutil.rmtree(folder / 'thermo')

        assert self.points(folder) == {'temperature_publisher': (15, [])}

    def test_a_zip_is_what_is_in_it(self, tmp_path):
        """An outer folder and the entries that macOS adds do not matter."""
        folder = package(tmp_path / 'a')
        with zipfile.ZipFile(tmp_path / 'a.zip', 'w') as archive:
            for path in sorted(folder.rglob('*.*')):
                archive.write(path, f'hand-in/{path.relative_to(folder)}')
            archive.writestr('__MACOSX/._x', 'x')

        assert self.points(tmp_path / 'a.zip') == {'temperature_publisher': (15, [])}

    def test_a_script_is_a_submission(self, tmp_path):
        shutil.copy(ROOT / PUBLISHER, tmp_path / 'my thermometer.py')

        found = self.points(tmp_path / 'my thermometer.py')

        assert found == {'temperature_publisher': (15, [])}

    def test_the_command_prints_every_check_and_shows_what_happens(self, tmp_path, capsys):
        arguments = ['run', '--exam', 'temperature_publisher', '--visible', '--live']

        assert command.main([*arguments, str(package(tmp_path / 'a'))]) == OK

        said = capsys.readouterr()
        assert said.out.count('[pass]') == 8
        assert 'Total: 15 of 15 points; visible checks; isolation: ' in said.out
        starts = said.err.split('-- the program is started a second time --')
        first, second = (
            [line for line in start.splitlines() if '/temperature_topic: ' in line]
            for start in starts
        )
        assert (len(first), len(second)) == (
            9,
            10,
        )  # at first, nothing subscribes
        assert first[0].strip().startswith('2.400s  /temperature_topic: temperature_value: 23.0')

    def test_a_notebook_is_one_too_and_json_has_all(self, tmp_path, capsys):
        sample = LAYOUT.sample_class / '07_temperature_monitor' / 'fail__two_hertz'
        notebook = tmp_path / 'temperature_monitor.ipynb'
        notebook.write_bytes(sample_class.compose(LAYOUT, '07_temperature_monitor', sample))
        arguments = ['run', '--exam', 'temperature_publisher', '--visible', '--json']

        assert command.main([*arguments, str(notebook)]) == OK

        (result,) = json.loads(capsys.readouterr().out)
        failed = {
            check['check']: check['cause_id']
            for check in result['checks']
            if check['verdict'] == 'FAILED'
        }
        assert failed == {'publishes_once_per_second': 'wrong_rate'}
