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
from roslab.gallery import entries, explain, LESSON, nearest

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
def test_heading_of_an_exhibit_leads_to_its_entry(entry):
    assert nearest(entry.heading)[0] == entry


def test_entries_and_exhibits_are_the_same():
    cells = sources()
    headings = {heading_of(text) for name, text in cells.items() if name.endswith('-what')}

    assert headings == {entry.heading for entry in entries()}
    for entry in entries():
        assert heading_of(cells[f'{entry.key}-what']) == entry.heading
        assert entry.key in cells
        assert f'{entry.key}-why' in cells


@each_entry
def test_exhibit_needs_the_setup_and_no_other_exhibit(entry):
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


LOG = 'Traceback ...\n  File "x.py"\nRuntimeError: Context.init() must only\n be called once\n'


@pytest.mark.parametrize(
    ('message', 'key'),
    [
        ("Package 'bumper_cars' not found", 'no-package'),
        ("property 'timers' of 'Clock' object has no setter", 'no-setter'),
        ("ModuleNotFoundError: No module named 'bumper_cars.msg'", 'no-msg'),
        ("The 'speed' field must be of type 'float'", 'int-field'),
        ("s.c:58: t__convert_from_py: Assertion `PyFloat_Check(field)' failed.", 'tiny'),
        (LOG, 'init-twice'),
    ],
)
def test_message_is_recognised_whatever_the_learners_names_are_and_in_a_long_log(message, key):
    assert nearest(message)[0].key == key


@pytest.fixture
def said(capsys):
    """Return a function that returns what explain() prints."""

    def explained(*error):
        explain(*error)
        return capsys.readouterr().out

    return explained


def test_explain_says_cause_repair_and_place(said):
    text = said('No executable found')

    assert text.startswith('What happened: The package has installed no program')
    assert 'Repair: Declare it in `entry_points`' in text
    assert f'More: lesson {LESSON}, "No executable found"' in text


def test_explain_takes_an_exception(said):
    assert 'Import it' in said(NameError("name 'Float32' is not defined"))


def test_explain_looks_at_the_last_error(said, monkeypatch):
    last = TypeError("'NoneType' object is not callable")
    monkeypatch.setattr(sys, 'last_value', last, raising=False)

    assert 'without brackets' in said()


def test_explain_without_an_error_says_what_to_give(monkeypatch):
    monkeypatch.delattr(sys, 'last_value', raising=False)

    with pytest.raises(RoslabError, match='there was no error'):
        explain()


@pytest.mark.parametrize('nonsense', [3, '', '  '])
def test_explain_refuses_what_is_no_error(nonsense):
    with pytest.raises(RoslabError, match='expected an error message'):
        explain(nonsense)


def test_explain_knows_the_errors_of_a_build(said):
    error = "CMake Error: the passed dependency 'geometry_msgs' has not been found before using"

    assert 'find_package(geometry_msgs REQUIRED)' in said(error)


def test_explain_says_what_it_does_not_know(said):
    text = said('RCLError: the robot has eaten the map')

    assert text.startswith('Not in the gallery: RCLError: the robot has eaten the map')
    assert 'What happened' not in text
    assert 'robotics.stackexchange.com' in text


def raised(code, name='__main__'):
    """Return the exception that this code raises in the module of this name."""
    with pytest.raises(Exception) as caught:  # noqa: PT011
        exec(code, {'__name__': name})
    return caught.value


@pytest.mark.parametrize(
    'error', [ZeroDivisionError(), raised('1 / 0'), 'IndexError: list index out of range']
)
def test_error_of_python_leads_to_its_manual(error, said):
    text = said(error)

    assert 'is an error of Python itself' in text
    assert 'docs.python.org' in text
    assert 'rclpy' not in text


@pytest.mark.parametrize(
    'error',
    [
        raised('raise RuntimeError("no more")', 'rclpy.node'),
        'RuntimeError: rcl_take failed, no more',
    ],
)
def test_builtin_error_that_ros_raises_leads_to_its_issues(error, said):
    assert 'github.com/ros2/rclpy' in said(error)


@pytest.mark.parametrize(
    ('written', 'meant'),
    [('tmie', 'time'), ('nunpy', 'numpy'), ('randm', 'random'), ('yaaml', 'yaml')],
)
def test_misspelt_module_is_named(written, meant, said):
    text = said(f"ModuleNotFoundError: No module named '{written}'")

    assert f'{meant} exists' in text
    assert 'source install' not in text


@pytest.mark.parametrize('name', ['weather_station', 'my_interfaces', 'tme', 'cv2'])
def test_module_that_nothing_resembles_may_be_misspelt_or_not_built(name, said):
    text = said(f"ModuleNotFoundError: No module named '{name}'")

    assert 'it is misspelt, not built, not installed' in text
