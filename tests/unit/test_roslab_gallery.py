"""The gallery of errors: explain() finds its entries, and lesson 08 has a cell for each."""

import ast
import builtins
import json
from pathlib import Path
import re
import sys

import pytest

from roslab.error_hints import defined_names
from roslab.errors import RoslabError
from roslab.gallery import entries, Entry, explain, LESSON, nearest

NOTEBOOK = Path(__file__).resolve().parents[2] / 'solutions' / LESSON / 'what_went_wrong.ipynb'

each_entry = pytest.mark.parametrize('entry', entries(), ids=lambda entry: entry.key)


def sources() -> dict[str, str]:
    """Return the cells of the lesson by their ids."""
    cells = json.loads(NOTEBOOK.read_text(encoding='utf-8'))['cells']
    return {cell['id']: ''.join(cell['source']) for cell in cells}


def heading_of(text: str) -> str:
    """Return the heading of a text cell, without the backticks around an error message."""
    return re.match(r'### (.*)\n', text)[1].strip('`')


@each_entry
def test_heading_of_an_exhibit_leads_to_its_entry(entry: Entry) -> None:
    assert nearest(entry.heading)[0] == entry


def test_entries_and_exhibits_are_the_same() -> None:
    cells = sources()
    headings = {heading_of(text) for name, text in cells.items() if name.endswith('-what')}

    assert headings == {entry.heading for entry in entries()}
    for entry in entries():
        assert heading_of(cells[f'{entry.key}-what']) == entry.heading
        assert entry.key in cells
        assert f'{entry.key}-why' in cells


@each_entry
def test_exhibit_needs_the_setup_and_no_other_exhibit(entry: Entry) -> None:
    """A reader may run only the setup and one cell; `caught` would hide a missing name."""
    cells = sources()
    ready = {
        name
        for where, text in cells.items()
        if where.startswith('setup-')
        for name in defined_names(text)
    }
    source = cells[entry.key]
    python = '\n'.join(line for line in source.splitlines() if not line.startswith(('!', '%%')))
    names = [node for node in ast.walk(ast.parse(python)) if isinstance(node, ast.Name)]
    used = {name.id for name in names if isinstance(name.ctx, ast.Load)}
    scoped = {node.arg for node in ast.walk(ast.parse(python)) if isinstance(node, ast.arg)}
    local = scoped | {name.id for name in names if isinstance(name.ctx, ast.Store)}

    lacking = used - ready - local - defined_names(source) - set(dir(builtins))
    assert lacking <= {'Float32'}  # the exhibit lacks its import


def test_names_of_a_learner_do_not_disturb() -> None:
    found = [
        nearest("Package 'bumper_cars' not found")[0].key,
        nearest("property 'timers' of 'Clock' object has no setter")[0].key,
        nearest("ModuleNotFoundError: No module named 'bumper_cars.msg'")[0].key,
        nearest("The 'speed' field must be of type 'float'")[0].key,
        nearest("s.c:58: t__convert_from_py: Assertion `PyFloat_Check(field)' failed.")[0].key,
    ]

    assert found == ['no-package', 'no-setter', 'no-msg', 'int-field', 'tiny']


def test_message_in_a_long_log_is_found() -> None:
    log = 'Traceback ...\n  File "x.py"\nRuntimeError: Context.init() must only\n be called once\n'

    assert nearest(log)[0].key == 'init-twice'


def test_explain_says_cause_repair_and_place(capsys: pytest.CaptureFixture[str]) -> None:
    explain('No executable found')

    said = capsys.readouterr().out
    assert said.startswith('What happened: The package has installed no program')
    assert 'Repair: Declare it in `entry_points`' in said
    assert f'More: lesson {LESSON}, "No executable found"' in said


def test_explain_takes_an_exception(capsys: pytest.CaptureFixture[str]) -> None:
    explain(NameError("name 'Float32' is not defined"))

    assert 'Import it' in capsys.readouterr().out


def test_explain_looks_at_the_last_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        sys, 'last_value', TypeError("'NoneType' object is not callable"), raising=False
    )
    explain()

    assert 'without brackets' in capsys.readouterr().out


def test_explain_without_an_error_says_what_to_give(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(sys, 'last_value', raising=False)

    with pytest.raises(RoslabError, match='there was no error'):
        explain()


@pytest.mark.parametrize('nonsense', [3, '', '  '])
def test_explain_refuses_what_is_no_error(nonsense: object) -> None:
    with pytest.raises(RoslabError, match='expected an error message'):
        explain(nonsense)


def test_explain_knows_the_errors_of_a_build(capsys: pytest.CaptureFixture[str]) -> None:
    explain("CMake Error: the passed dependency 'geometry_msgs' has not been found before using")

    assert 'find_package(geometry_msgs REQUIRED)' in capsys.readouterr().out


def test_explain_says_what_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    explain('RCLError: the robot has eaten the map')

    said = capsys.readouterr().out
    assert said.startswith('Not in the gallery: RCLError: the robot has eaten the map')
    assert 'What happened' not in said
    assert 'robotics.stackexchange.com' in said


def raised(code: str, name: str = '__main__') -> BaseException:
    """Return the exception that this code raises in the module of this name."""
    try:
        exec(code, {'__name__': name})
    except Exception as error:
        return error
    raise AssertionError('nothing was raised')


@pytest.mark.parametrize(
    'error', [ZeroDivisionError(), raised('1 / 0'), 'IndexError: list index out of range']
)
def test_error_of_python_leads_to_its_manual(
    error: str | BaseException, capsys: pytest.CaptureFixture[str]
) -> None:
    explain(error)

    said = capsys.readouterr().out
    assert 'is an error of Python itself' in said
    assert 'docs.python.org' in said
    assert 'rclpy' not in said


@pytest.mark.parametrize(
    'error',
    [
        raised('raise RuntimeError("no more")', 'rclpy.node'),
        'RuntimeError: rcl_take failed, no more',
    ],
)
def test_builtin_error_that_ros_raises_leads_to_its_issues(
    error: str | BaseException, capsys: pytest.CaptureFixture[str]
) -> None:
    explain(error)

    assert 'github.com/ros2/rclpy' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('written', 'meant'),
    [('tmie', 'time'), ('nunpy', 'numpy'), ('randm', 'random'), ('yaaml', 'yaml')],
)
def test_misspelt_module_is_named(
    written: str, meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    explain(f"ModuleNotFoundError: No module named '{written}'")

    said = capsys.readouterr().out
    assert f'{meant} exists' in said
    assert 'source install' not in said


@pytest.mark.parametrize('name', ['weather_station', 'my_interfaces', 'tme', 'cv2'])
def test_module_that_nothing_resembles_may_be_misspelt_or_not_built(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    explain(f"ModuleNotFoundError: No module named '{name}'")

    assert 'it is misspelt, not built, not installed' in capsys.readouterr().out
