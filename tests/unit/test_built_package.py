"""Packages that colcon builds: added files, executables, and explanations of failures."""

import importlib
import json

import pytest

from autograder.exam import catalog
from autograder.exam.exam import Run
from autograder.grading.built_package import as_package, explained, package_name
from autograder.judging.causes import builds as packages
from autograder.judging.causes.builds import MARK
from autograder.recording import Recording
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.sandboxes.sandbox import HERE

XML = '<package format="3">\n  <name> thermo </name>\n</package>'
EXAM = as_package(catalog.load('temperature_publisher', hidden=False), 'thermo')


def test_a_package_has_a_manifest_with_a_name_and_says_how_it_is_built():
    """A folder with only modules or only a manifest is graded without a build."""
    assert package_name({'package.xml': XML, 'setup.py': ''}) == 'thermo'
    assert package_name({'package.xml': XML, 'CMakeLists.txt': ''}) == 'thermo'
    assert package_name({'package.xml': XML}) == ''
    assert package_name({'setup.py': ''}) == ''
    assert package_name({'package.xml': '<name>../evil</name>', 'setup.py': ''}) == ''


def test_the_exam_stays_the_same_but_for_what_runs():
    exam = catalog.load('temperature_publisher', hidden=False)

    assert EXAM.checks == exam.checks
    assert EXAM.scenario.steps == exam.scenario.steps
    assert (EXAM.scenario.program, EXAM.scenario.build_type) == ('package', 'thermo')
    names = {'package': 'thermo', 'executable': 'temp_publisher'}
    assert EXAM.facts == {**exam.facts, **names}
    assert EXAM.requires == ()
    assert exam.scenario.program == 'node'


def test_an_exam_that_builds_anyway_stays_as_it_is():
    """The message exam already builds every submission."""
    exam = catalog.load('temperature_message', hidden=False)

    assert as_package(exam, 'thermo') is exam


def test_both_starts_run_the_executable():
    exam = as_package(catalog.load('courier', hidden=False), 'thermo')

    assert [(one.program, one.build_type) for one in exam.scenario.starts] == [
        ('package', 'thermo'),
        ('package', 'thermo'),
    ]


def first_check(code, stderr, files):
    """Return the first check of a run that ended with this exit code."""
    check = CheckResult(
        'starts_its_node', 'It starts.', Verdict.FAILED, 0, 2, 'a node', 'none', 'It died.'
    )
    process = {'event': 'process', 'exit': code, 'killed': '', 'stderr': stderr, 'stdout': ''}
    result = ExamResult(EXAM.name, (check,))
    return explained(EXAM, result, Recording({}, [process]), files).checks[0]


def ended(error, exit=1):
    """Return the end of a process with an exception."""
    stderr = f'Traceback (most recent call last):\n{error}\n'
    return Recording({}, [{'event': 'process', 'exit': exit, 'stderr': stderr}])


NOT_CALLABLE = "TypeError: 'module' object is not callable"


def there(**places):
    """Return the line that lists the installed executables."""
    return MARK + json.dumps({'lib': [], 'bin': [], **places})


@pytest.mark.parametrize(
    ('files', 'installed', 'cause_id', 'words'),
    [
        (['setup.py'], {}, 'entry_point_missing', 'console_scripts'),
        (['setup.py'], {'bin': ['temp_publisher']}, 'script_folder', 'install_scripts'),
        (['setup.py'], {'others': ['other']}, 'script_folder', '$base/lib/thermo'),
        (['CMakeLists.txt'], {'lib': ['other']}, 'executable_not_installed', 'install(PROGRAMS'),
    ],
)
def test_an_executable_that_is_not_there_is_named_with_the_file_to_mend(
    files, installed, cause_id, words
):
    check = first_check(97, there(**installed), dict.fromkeys(files, ''))

    assert check.cause_id == cause_id
    assert words in check.try_this
    assert 'ros2 run thermo temp_publisher' in check.expected
    assert ', '.join(installed.get('lib', [])) in check.observed


@pytest.mark.parametrize(
    ('error', 'cause_id', 'words'),
    [
        ("ModuleNotFoundError: No module named 'thermo'", 'no_modules', 'find_packages'),
        ("ModuleNotFoundError: No module named 'a'", 'entry_point_module', 'thermo.MODULE:main'),
        ("AttributeError: module 'thermo.a' has no attribute 'b'", 'entry_point_function', 'b'),
        (NOT_CALLABLE, 'entry_point_function', 'no function'),
    ],
)
def test_entry_point_that_leads_nowhere_is_named(error, cause_id, words):
    """The entry point is named, because the traceback has no line of the student's code."""
    recording = ended(f'  File "/ws/lib/thermo/temp_publisher", line 33\n{error}')
    setup = {'setup.py': "# temp_publisher = a:main\n\n    'temp_publisher = thermo.a',\n"}
    why = packages.why_no_program(Run(setup, recording, EXAM.facts))

    assert why.cause_id == cause_id
    assert words in f'{why.text} {why.try_this}'
    # The cause no_modules blames a different line: the one with packages=.
    assert why.text.startswith('setup.py, line 3: ') == (cause_id != 'no_modules')


def test_entry_point_of_setup_cfg_has_its_line_there():
    entry = 'console_scripts =\n  temp_publisher=thermo.a\n'
    files = {'setup.py': 'setup()\n', 'setup.cfg': entry}

    why = packages.why_no_program(Run(files, ended(NOT_CALLABLE), EXAM.facts))

    assert why.text.startswith('setup.cfg, line 2: ')


def test_thread_that_calls_a_module_is_no_entry_point():
    """An exception in a thread does not end the program, so the exit code is 0."""
    assert packages.why_no_program(Run({}, ended(NOT_CALLABLE, 0), EXAM.facts)) is None


@pytest.mark.parametrize(
    'line', ['', 'run_package: {', 'run_package: [1]', 'run_package: {"lib": 3}']
)
def test_what_a_build_prints_is_not_believed(line):
    assert first_check(97, line, {'setup.py': ''}).cause_id == 'entry_point_missing'


def test_a_failed_build_says_what_is_wrong():
    check = first_check(98, 'CMake Error: something odd', {'CMakeLists.txt': ''})

    assert check.expected == 'a package that colcon can build'
    assert check.cause


def test_any_other_end_keeps_the_words_of_the_exam():
    """A program that dies is explained as in an exam without a build."""
    assert first_check(1, '', {}).cause == 'It died.'


@pytest.mark.parametrize(
    'words', ['Line {}: It fails.', 'Line {}, in tick(): It fails.', 'Lines {} and {}: Both fail.']
)
def test_lines_are_those_of_the_file(words):
    """Line numbers count from the beginning of the file, which has no magic line."""
    check = CheckResult('a', 'A.', Verdict.FAILED, 0, 1, cause=words.format(8, 10))
    result = explained(EXAM, ExamResult('x', (check,)), None, {})

    assert result.checks[0].cause == words.format(7, 9)


@pytest.fixture
def inside(monkeypatch):
    """Return a function that imports a script of the sandbox."""
    monkeypatch.syspath_prepend(str(HERE / 'inside'))
    return importlib.import_module


def test_both_sides_mean_the_same_codes(inside):
    """The script in the sandbox repeats the exit codes, as it imports nothing of the project."""
    run_package = inside('run_package')

    assert (run_package.NO_EXECUTABLE, run_package.NOT_BUILT, run_package.MARK) == (
        packages.NO_EXECUTABLE,
        packages.NOT_BUILT,
        packages.MARK,
    )


@pytest.fixture
def build_package(inside):
    """Return the script, which runs inside the sandbox."""
    return inside('build_package')


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob('*.*'))


def written(folder, *files):
    for name in files:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).touch()
    return folder


def test_cells_become_a_package(build_package, tmp_path):
    """A node goes into the inner folder, and every other file stays where it is."""
    folder = written(tmp_path, 'setup.py', 'a.py', 'config/a.yaml')
    build_package.add_package_files(folder, 'pack')

    assert names(folder) == ['config/a.yaml', 'pack/__init__.py', 'pack/a.py', 'setup.py']
    assert (folder / 'resource' / 'pack').is_file()


@pytest.mark.parametrize(
    'files',
    [
        ('CMakeLists.txt', 'a.py'),
        ('setup.py', 'a.py', 'pack/__init__.py'),
        ('setup.py', 'a.py', 'resource/pack'),
    ],
)
def test_whole_package_stays_as_it_is(build_package, tmp_path, files):
    """The grader adds nothing to a whole package: its mistakes are the student's."""
    before = names(written(tmp_path, *files))
    build_package.add_package_files(tmp_path, 'pack')

    assert names(tmp_path) == before
