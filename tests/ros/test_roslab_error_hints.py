"""One sentence in place of a traceback: which cell to run first."""

from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest

pytest.importorskip('rclpy')

from roslab import error_hints

pytestmark = pytest.mark.ros

MARKDOWN, CODE = nbformat.v4.new_markdown_cell, nbformat.v4.new_code_cell


@pytest.fixture
def notebook(tmp_path, monkeypatch):
    """Return a small lesson, the only notebook of the working folder."""
    cells = [
        MARKDOWN('# A lesson\n\n## Setup'),
        CODE('import time\nfrom roslab import *'),
        MARKDOWN('## Part 1'),
        CODE('%%node blinker\nimport math\n_hidden = 1\nclass Blinker: pass'),
        CODE('%%capture noise\nloud = !ls'),
        CODE(
            '%matplotlib inline\nwith open("f") as file:\n    for line in file: a, (b, *c) = 1, 2'
        ),
    ]
    path = tmp_path / 'lesson.ipynb'
    nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv('JPY_SESSION_NAME', raising=False)
    return path


# The parts of IPython's shell that the extension uses.
SHELL = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=('', 'the running cell')))


def advice_for(code):
    """Return the advice for the error that code raises."""
    try:
        exec(compile(code, 'cell.py', 'exec'), {})
    except BaseException as error:
        return error_hints.advice(error, SHELL)
    raise AssertionError('nothing was raised')


@pytest.mark.parametrize(
    ('code', 'section', 'first_line'),
    [
        ('start(1)', 'Setup', 'import time'),
        ('Blinker()', 'Part 1', '%%node blinker'),
        ('math', 'Part 1', '%%node blinker'),
        ('c', 'Part 1', '%matplotlib inline'),
        ('file', 'Part 1', '%matplotlib inline'),
        ('noise', 'Part 1', '%%capture noise'),
        ('exec("loud")', 'Part 1', '%%capture noise'),
        ('import blinker', 'Part 1', '%%node blinker'),
    ],
)
def test_name_of_another_cell_is_answered_with_that_cell(notebook, code, section, first_line):
    """The sentence has the section and the first line of the cell to run."""
    said = advice_for(code)

    assert f'in "{section}"' in said
    assert said.endswith(first_line)


@pytest.mark.parametrize(
    'code',
    [
        'nowhere',
        '_hidden',
        'import nowhere_at_all',
        '1 / 0',
        'def f():\n    print(x)\n    x = 1\nf()',
    ],
)
def test_other_errors_stay_as_they_are(notebook, code):
    """The extension does not replace errors about misspelt or private names, or other errors."""
    assert advice_for(code) is None


def test_stub_of_an_exercise_says_what_to_do(notebook):
    """The advice is to replace the line, not to run other cells."""
    said = advice_for('def to_celsius():\n    raise NotImplementedError()\nto_celsius()')

    assert 'line 2' in said
    assert 'Replace that line with your own code' in said


def test_magic_below_a_comment_is_explained(notebook):
    """IPython reports a missing line magic, which does not help a beginner."""
    said = advice_for(
        'from IPython.core.error import UsageError\n'
        "raise UsageError('Line magic function `%%node` not found.')"
    )

    assert '%%node has to be the first line of its cell' in said


@pytest.fixture
def run_in_order(notebook, monkeypatch):
    """Return a function that marks cells as run, some of them edited, and returns the hint."""
    cells = error_hints.read_cells(notebook)
    history = ['']
    shell = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=history))
    running = SimpleNamespace(request={})
    monkeypatch.setattr(error_hints, 'current_cell', lambda: running)
    monkeypatch.setattr(error_hints, '_executed', {})
    monkeypatch.setattr(error_hints, '_failed', set())

    def run(edited=(), left_out=(), again=()):
        numbers = [number for number, _ in enumerate(cells) if number not in left_out]
        for number in (*numbers, *again):
            running.request = {'metadata': {'cellId': cells[number].identifier}}
            error_hints._note(shell)
            history.append('# mine' if number in edited else cells[number].source)
        return error_hints._out_of_order(shell)

    return run


@pytest.mark.parametrize('edited', [(), (1,), (0, 1, 2, 3)])
def test_cells_that_were_edited_and_not_saved_have_run_all_the_same(run_in_order, edited):
    """An error below a solved exercise is not blamed on the order of the cells."""
    assert run_in_order(edited=edited) is None


def test_cell_that_was_left_out_is_reported(run_in_order):
    """A learner who skipped a cell gets the hint."""
    assert 'Run first' in run_in_order(left_out=(1,))


def test_cell_below_that_ran_earlier_is_no_wrong_order(run_in_order):
    """After a check, the learner corrects the answer above it and tries the answer again."""
    assert run_in_order(again=(1, 2)) is None


def test_texts_are_those_that_ran_last(notebook, monkeypatch):
    """A cell that ran has the text that ran; other cells have the saved text."""
    cells = error_hints.read_cells(notebook)
    monkeypatch.setattr(error_hints, '_executed', {1: cells[1].identifier, 3: cells[1].identifier})
    history = ['', 'older', 'typed in a console', 'newer']
    shell = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=history))

    texts = error_hints.texts_now(shell)

    assert set(texts) == {
        'newer',
        'typed in a console',
        '',
        *(one.source for one in cells if one is not cells[1]),
    }


def test_error_inside_a_library_stays_as_it_is(notebook, tmp_path, monkeypatch):
    """A name that is missing in an installed module is not the learner's mistake."""
    installed = tmp_path / 'site-packages'
    installed.mkdir()
    (installed / 'careless.py').write_text('def call():\n    return start\n')
    monkeypatch.syspath_prepend(installed)

    assert advice_for('import careless\ncareless.call()') is None
    assert 'Setup' in advice_for('def call():\n    return start\ncall()')


def test_notebook_that_cannot_be_found_leaves_the_plain_error(notebook):
    """With two notebooks in the folder, the extension does not know which one this is."""
    notebook.with_name('other.ipynb').write_text(notebook.read_text())

    assert error_hints.notebook_path() is None
    assert advice_for('start(1)') is None


def test_server_names_the_notebook(notebook, monkeypatch):
    """JupyterLab tells the kernel, so other notebooks in the folder do not matter."""
    notebook.with_name('other.ipynb').write_text('not json')
    monkeypatch.setenv('JPY_SESSION_NAME', str(notebook))

    assert error_hints.notebook_path() == notebook
    assert 'Setup' in advice_for('start(1)')


def test_damaged_notebook_has_no_cells(tmp_path):
    path = tmp_path / 'damaged.ipynb'
    path.write_text('{"cells": [1]}')

    assert error_hints.read_cells(path) == []
    assert error_hints.read_cells(Path('/nowhere.ipynb')) == []
