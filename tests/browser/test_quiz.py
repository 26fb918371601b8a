"""
A practice question in JupyterLab, answered by keyboard alone.

    make test-browser ARGS='-k quiz'
"""

from pathlib import Path
from typing import Any

from conftest import Lab
import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
import pytest

from roslab.progress import read_results
from roslab.quiz import find, Question

pytestmark = [pytest.mark.browser, pytest.mark.slow]

KEY = '07-package-kind'
OPEN_MS = 60_000
CELL_MS = 60_000
MOST_TABS = 40
FOCUSED = """() => {
    const one = document.activeElement;
    return one.type === 'radio' ? Number(one.value) : -1;
}"""


@pytest.fixture
def question(lab: Lab, page: Any) -> Question:
    """Open a notebook, run its question with the keyboard, and return the question."""
    from playwright.sync_api import expect

    cells = [
        new_code_cell(f"from roslab import quiz\n\nquiz('{KEY}')"),
        new_markdown_cell('The cell below.'),
    ]
    metadata = {'kernelspec': {'name': 'ros2_jazzy', 'display_name': 'ROS 2 Jazzy'}}
    nbformat.write(new_notebook(cells=cells, metadata=metadata), lab.course / 'quiz.ipynb')
    page.goto(lab.url('quiz.ipynb'))
    ready = page.locator('#jp-main-statusbar', has_text='ROS 2 Jazzy | Idle')
    expect(ready).to_be_visible(timeout=OPEN_MS)
    page.locator('.jp-CodeCell .jp-InputArea').first.click()
    page.keyboard.press('Control+Enter')
    expect(page.get_by_role('radio')).to_have_count(4, timeout=CELL_MS)
    return find(KEY)


def tab_to_options(page: Any) -> int:
    """Press Tab until an option has the focus, and return its number."""
    for _ in range(MOST_TABS):
        page.keyboard.press('Tab')
        if (number := page.evaluate(FOCUSED)) >= 0:
            return int(number)
    raise AssertionError(f'no option has the focus after {MOST_TABS} tabs')


def test_question_is_answered_by_keyboard_alone(
    lab: Lab, page: Any, shots: Path, question: Question
) -> None:
    """Arrows choose, Enter and Space answer, each option has an explanation, retries work."""
    from playwright.sync_api import expect

    status = page.get_by_role('status').filter(has=page.locator(':scope.roslab-quiz-why'))
    options = page.get_by_role('radio')
    right = [option.right for option in question.options].index(True)
    wrong = (right + 1) % len(question.options)
    expect(page.get_by_role('group', name=question.text.replace('`', ''))).to_be_visible()
    expect(status).to_have_text('')

    at = tab_to_options(page)
    for number in range(len(question.options)):
        # The arrow keys wrap around within the question, and do not reveal the answer.
        page.keyboard.press('ArrowDown')
        at = (at + 1) % len(question.options)
        assert page.evaluate(FOCUSED) == at, number
        expect(options.nth(at)).to_be_checked()
        expect(status).to_have_text('Press Enter or Space to answer.')
    while at != wrong:
        page.keyboard.press('ArrowUp')
        at = (at - 1) % len(question.options)
    page.keyboard.press('Enter')
    expect(status).to_contain_text('Not right. ' + question.options[wrong].why.replace('`', ''))
    expect(status).to_contain_text('Try another one.')
    page.screenshot(path=shots / 'wrong.png')

    while at != right:
        page.keyboard.press('ArrowDown')
        at = (at + 1) % len(question.options)
    page.keyboard.press('Space')
    expect(status).to_contain_text('Right. ' + question.options[right].why.replace('`', ''))
    expect(options.nth(right)).to_be_checked()
    page.screenshot(path=shots / 'right.png')
    remembered = read_results(lab.course / 'autograder' / '_work' / 'progress.json')
    assert remembered['quizzes'][KEY] is True
    # JupyterLab handled none of the keys: no cell was added, deleted, cut or run again.
    assert page.locator('.jp-Cell').count() == 2
    expect(page.locator('.jp-CodeCell .jp-InputPrompt')).to_have_text('[1]:')
    assert page.errors == []


def test_shortcuts_with_a_modifier_stay_those_of_jupyterlab(
    lab: Lab, page: Any, question: Question
) -> None:
    """Ctrl+S saves and Shift+Enter runs the cell, even while an option has the focus."""
    from playwright.sync_api import expect

    tab_to_options(page)
    page.keyboard.press('Control+s')
    expect(page.locator('.lm-TabBar-tab.jp-mod-current.jp-mod-dirty')).to_have_count(0)
    stored = nbformat.read(lab.course / 'quiz.ipynb', as_version=4)
    (shown,) = stored.cells[0].outputs
    assert shown.data['text/plain'] == str(question)

    before = page.locator('.jp-CodeCell .jp-InputPrompt').inner_text()
    page.keyboard.press('ArrowDown')
    page.keyboard.press('Space')
    expect(page.locator('.roslab-quiz-why')).not_to_be_empty()
    page.keyboard.press('Shift+Enter')
    expect(page.locator('.jp-CodeCell .jp-InputPrompt')).not_to_have_text(before)
    expect(page.locator('.roslab-quiz-why')).to_be_empty()
    assert page.errors == []


def test_mouse_answers_at_once_in_a_dark_theme(page: Any, shots: Path, question: Question) -> None:
    """A click on the text of an option answers the question, and code is shown as code."""
    from playwright.sync_api import expect

    page.locator('.lm-MenuBar-itemLabel:text-is("Settings")').click()
    page.locator('.lm-Menu-itemLabel:text-is("Theme")').click()
    page.locator('.lm-Menu-itemLabel:text-is("JupyterLab Dark")').click()
    expect(page.locator('body')).to_have_attribute('data-jp-theme-light', 'false')
    right = [option.right for option in question.options].index(True)
    page.locator('.roslab-quiz label').nth(right).click()
    status = page.locator('.roslab-quiz-why')
    expect(status).to_contain_text('Right. ')
    page.screenshot(path=shots / 'dark.png')

    assert page.locator('.roslab-quiz legend code').all_inner_texts() == [
        'ament_python',
        'msg/Temperature.msg',
        'colcon build',
        'from temp_monitor_pkg.msg import Temperature',
    ]
    assert '`' not in page.locator('.roslab-quiz').inner_text()
    assert page.errors == []
