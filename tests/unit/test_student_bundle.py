"""The files that students receive, and those that only instructors have."""

from collections.abc import Container
import os
from pathlib import Path
import posixpath
import re
import shutil
import subprocess
import sys
import zipfile

from collect_sources import laid
import pytest

from autograder.authoring import student_bundle
from autograder.layout import Layout
from autograder.submission.notebook import read_release
from environment import packed_package
from tests.judgement.references import exercises

LINK = re.compile(r'\]\((?!\w+:)([^)#\s]+)')
PACKED = 'temp_monitor_pkg/packed.bin'
ROOT = Layout.here().root
KINDS = ('check_your_understanding', 'managed_beacon', 'temperature_message', 'talker')
"""Exams without a run, with a managed node, with a build, and with a node."""
IMPORT_ALL = """
import importlib, pkgutil, sys
import autograder, roslab
for package in (autograder, roslab):
    for found in pkgutil.walk_packages(package.__path__, f'{package.__name__}.'):
        if not found.name.startswith(('autograder.inside', 'autograder.probe', 'roslab.ros2.__')):
            importlib.import_module(found.name)
print(autograder.__file__)
"""
HELP = re.compile(r'^  make ([a-z]+)', re.M)


def dead_links(name: str, path: Path, files: Container[str]) -> list[str]:
    """Return the relative links of a page or a lesson that lead to none of the given files."""
    if path.suffix == '.ipynb':
        cells = read_release(path)['cells']
        text = '\n'.join(cell['source'] for cell in cells if cell['cell_type'] == 'markdown')
    else:
        text = path.read_text(encoding='utf-8') if path.suffix == '.md' else ''
    folder = posixpath.dirname(name)
    return [
        f'{name}: {link}'
        for link in LINK.findall(re.sub(r'```.*?```|`[^`\n]+`', '', text, flags=re.DOTALL))
        if posixpath.normpath(posixpath.join(folder, link)) not in files
    ]


GOES = [
    'autograder/judging/judge.py',
    'exams/visible/talker.py',
    'notebooks/01/a.ipynb',
    'roslab/session.py',
    'temp_monitor_pkg/launch/x.launch.py',
]
STAYS = [
    'instructors.mk',
    'nbgrader_config.py',
    'notebooks/01/ros_ws/src/x.py',
    'solutions/01/a.ipynb',
    'autograder/__main__.py',
    'autograder/judging/__pycache__/judge.pyc',
    'exams/hidden/talker.py',
    'autograder/new_part/new.py',
    'autograder/classroom/similarity.py',
    'autograder/_work/gradebook.db',
    'tests/submissions/01/pass__reference/expected.json',
    'temp_monitor_pkg/msg/Num.msg',
    'temp_monitor_pkg/test/x.py',
]


class TestPacking:
    @pytest.fixture
    def layout(self, tmp_path, monkeypatch):
        names = (*GOES, *STAYS, 'README.md', 'docs/students.md')
        laid(tmp_path, {name: name.encode() for name in names})
        shutil.copy(ROOT / 'course.toml', tmp_path)
        monkeypatch.setattr(student_bundle, 'PROJECT', tmp_path)
        (tmp_path / 'roslab' / 'link.py').symlink_to(tmp_path / 'solutions/01/a.ipynb')
        return Layout(tmp_path)

    def test_only_what_is_named_goes(self, layout):
        fixed = ['.github/workflows/classroom.yml', 'LICENSE', 'Makefile', 'README.md']
        fixed += ['course.toml', 'environment.md', 'pixi.toml']

        assert sorted(student_bundle.bundled_files(layout)) == sorted([*GOES, *fixed])

    def test_the_same_course_gives_the_same_bytes(self, layout, tmp_path):
        first, second = tmp_path / 'a.zip', tmp_path / 'b.zip'

        assert student_bundle.pack(layout, first) == student_bundle.pack(layout, second) == 13
        assert first.read_bytes() == second.read_bytes()
        assert zipfile.ZipFile(first).testzip() is None

    def test_a_bundle_that_cannot_be_made_leaves_the_one_before(
        self, layout, tmp_path, monkeypatch
    ):
        """Otherwise students could receive half a bundle."""
        student_bundle.pack(layout, tmp_path / 'a.zip')
        before = (tmp_path / 'a.zip').read_bytes()
        broken = {'a': layout.root / 'README.md', 'b': layout.root / 'not there'}
        monkeypatch.setattr(student_bundle, 'bundled_files', lambda layout: broken)
        with pytest.raises(FileNotFoundError):
            student_bundle.pack(layout, tmp_path / 'a.zip')

        assert (tmp_path / 'a.zip').read_bytes() == before

    def test_its_readme_is_the_page_for_students(self, layout, tmp_path):
        """The project's README describes grading, and links to pages that students do not have."""
        student_bundle.pack(layout, tmp_path / 'a.zip')

        bundle = zipfile.ZipFile(tmp_path / 'a.zip')
        assert bundle.read('ros2-course/README.md') == b'docs/students.md'
        assert 'ros2-course/docs/students.md' not in bundle.namelist()


@pytest.fixture(scope='module')
def copy(tmp_path_factory):
    """Return the folder of this course's bundle, unpacked as by a student."""
    folder = tmp_path_factory.mktemp('student')
    student_bundle.pack(Layout.here(), folder / 'bundle.zip')
    with zipfile.ZipFile(folder / 'bundle.zip') as bundle:
        for name in bundle.namelist():
            bundle.extract(name, folder)
    return folder / student_bundle.TOP


def names_in(copy):
    return {path.relative_to(copy).as_posix(): path for path in copy.rglob('*') if path.is_file()}


def run_in(copy, *command, **options):
    return subprocess.run(command, cwd=copy, capture_output=True, text=True, **options)


def made(goal, copy):
    """Run make, without the variables of a make that runs the tests."""
    own = {name: text for name, text in os.environ.items() if not name.startswith('MAKE')}
    return run_in(copy, 'make', goal, env=own)


class TestThisCourse:
    def test_every_named_file_and_folder_is_there(self):
        missing = [one for one in student_bundle.ALLOWED if not (ROOT / one).exists()]

        assert missing == []

    def test_it_has_nothing_of_the_instructors(self, copy):
        parts = re.compile(
            'hidden|solutions|submissions|_work|gradebook|autograder/classroom|collect|exports'
            '|commands/grade|instructors|nbgrader_config|self_check|similar'
        )

        assert [name for name in names_in(copy) if parts.search(name)] == []

    def test_it_has_the_workflow_its_module_and_the_list_of_further_messages(self, copy):
        expected = '.github/workflows/classroom.yml', 'autograder/workflow/__main__.py'

        assert {*expected, 'environment/messages.txt'} <= {*names_in(copy)}

    def test_no_answer_of_lesson_07_is_a_readable_file(self, copy):
        names = {Path(name).name for name in names_in(copy)}
        answers = {'temp_publisher.py', 'temp_subscriber.py', 'Temperature.msg', 'package.xml'}

        assert not names & {*answers, 'CMakeLists.txt'}
        assert (copy / PACKED).is_file()
        assert b'create_publisher' not in (copy / PACKED).read_bytes()

    @pytest.mark.slow
    def test_everything_that_it_imports_is_in_it(self, copy):
        done = run_in(copy, sys.executable, '-c', IMPORT_ALL)

        assert done.stderr == ''
        assert done.stdout == f'{copy}/autograder/__init__.py\n'

    def test_no_page_of_it_leads_to_a_file_that_is_not_in_it(self, copy):
        """Text cells of lessons are tested too. The project's README would fail this test."""
        files = names_in(copy)
        dead = [link for name, path in files.items() for link in dead_links(name, path, files)]

        assert 'README.md' in files
        assert dead == []
        assert 'README.md: ARCHITECTURE.md' in dead_links('README.md', ROOT / 'README.md', files)

    def test_its_make_help_lists_what_works_there(self, copy):
        goals = HELP.findall(made('help', copy).stdout)
        page = (copy / 'README.md').read_text(encoding='utf-8')

        assert goals == ['lab', 'publisher', 'subscriber', 'prepare', 'doctor', 'clean']
        assert set(re.findall(r'\bmake ([a-z]+)', page)) <= {*goals, 'help'}

    def test_a_goal_that_it_does_not_have_is_one_line(self, copy):
        done = made('grade', copy)

        assert done.returncode == 2
        assert done.stderr.startswith('make grade: this copy of the course has no such goal')

    @pytest.mark.ros
    @pytest.mark.slow
    @pytest.mark.parametrize('name', KINDS)
    def test_its_visible_checks_judge_a_right_answer(self, copy, name, tmp_path):
        (exercise,) = (one for one in exercises() if one.name == name)
        laid(tmp_path, {file: text.encode() for file, text in exercise.files.items()})
        command = (sys.executable, '-m', 'autograder.commands.check', name, '--visible')
        done = run_in(copy, *command, '--files', str(tmp_path))

        assert done.stderr == ''
        assert '[pass]' in done.stdout
        assert '[FAIL]' not in done.stdout


class TestPackedPackage:
    def test_it_unpacks_to_the_same_package_without_words(self, tmp_path):
        package = ROOT / 'temp_monitor_pkg'
        packed_package.unpack(packed_package.pack(package), tmp_path)
        module = tmp_path / 'temp_monitor_pkg' / 'temp_publisher.py'

        modules = {path.name for path in (package / 'temp_monitor_pkg').glob('*.py')}
        text = module.read_text(encoding='utf-8')
        built = (tmp_path / 'CMakeLists.txt').read_bytes()
        assert built == (package / 'CMakeLists.txt').read_bytes()
        assert {path.name for path in module.parent.iterdir()} == modules
        assert 'class TemperaturePublisher(Node)' in text
        assert '"""' not in text

    @pytest.mark.parametrize(
        ('text', 'bare'),
        [
            ('"""Doc."""\nx = 1  # why', 'x = 1'),
            ('def f():\n    """Doc."""', 'def f():\n    pass'),
            ("class A:\n    'Doc.'\n    x = 'kept'", "class A:\n    x = 'kept'"),
        ],
    )
    def test_docstrings_and_comments_are_left_out(self, text, bare):
        assert packed_package.without_words(text) == bare
