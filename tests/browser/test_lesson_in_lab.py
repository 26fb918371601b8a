"""
Use the lesson and the grader as people do, in JupyterLab in a headless Chromium.

    make test-browser                        # installs Playwright, looks for a Chromium
    make test-browser ARGS='-k formgrader'

Screenshots are kept in pytest's temporary folder; a failed test prints its path.
"""

import json
from pathlib import Path
from typing import Any

from conftest import ASSIGNMENT, Lab
from lab_page import (
    CELL_MS,
    cell_with,
    choose,
    LESSON_MS,
    OPEN_MS,
    open_notebook,
    TROUBLE,
    wait_until_run,
    WITHOUT_WORDS,
)
import pytest

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

NOTEBOOK = 'temperature_monitor.ipynb'
CHECKS = (
    ('temperature_message', 10),
    ('temperature_publisher', 15),
    ('temperature_subscriber', 15),
    ('limit_keeper', 10),
)
WRAPPING = """() => [...new Set([...document.querySelectorAll('.jp-OutputArea-output pre')]
    .map(output => getComputedStyle(output).wordBreak))]"""
"""Returns how lines of output are broken; JupyterLab's default is break-all."""
RUNS_AND_SHOWS = """
([cell, words, trouble]) => document.querySelector(trouble) !== null
    || cell.querySelector('.jp-InputPrompt').textContent.includes('*')
    && cell.querySelector('.jp-Cell-outputArea').textContent.includes(words)
"""


def test_solved_lesson_runs_live_and_shows_full_points(lab: Lab, page: Any, shots: Path) -> None:
    """Every cell runs, readings appear while their cell is running, and the tables are green."""
    from playwright.sync_api import expect

    open_notebook(lab, page, f'lesson/{NOTEBOOK}')
    choose(page, 'Run', 'Run All Cells')
    live = cell_with(page, 'start(TemperaturePublisher)', 'readings.wait')
    live.scroll_into_view_if_needed()
    page.wait_for_function(
        RUNS_AND_SHOWS,
        arg=[live.element_handle(), '[INFO] [temperature_publisher]: ', TROUBLE],
        timeout=LESSON_MS,
    )
    assert page.locator(TROUBLE).all_inner_texts() == []
    live.screenshot(path=shots / 'live.png')
    wait_until_run(page.locator('.jp-CodeCell').last, LESSON_MS)

    # Each line is under the cell that caused it, even when cells run in quick succession.
    for fed, warnings in (('feed([(29.9', 2), ('feed([(300.0', 1)):
        output = cell_with(page, fed).locator('.jp-Cell-outputArea')
        assert output.inner_text().count('[WARN] [temperature_subscriber]') == warnings
    for title in ('Plot of /temperature_topic temperature_value', 'ROS graph'):
        pictures = page.get_by_role('img', name=title)
        expect(pictures).to_have_count(1)
    for exam, points in CHECKS:
        shown = cell_with(page, f"check('{exam}')").locator('.jp-Cell-outputArea')
        shown.scroll_into_view_if_needed()
        page.screenshot(path=shots / f'{exam}.png')

        expect(shown).to_contain_text(f'{exam}: {points} of {points} points')
        expect(shown).not_to_contain_text('[INFO]')
        marks = shown.locator('.check strong').all_inner_texts()
        assert len(marks) > 3
        assert set(marks) == {'✓ Passed:'}
    assert page.evaluate(WITHOUT_WORDS) == []
    assert page.evaluate(WRAPPING) == ['normal']
    assert page.locator(TROUBLE).all_inner_texts() == []
    assert page.errors == []
    assert 'without encryption' not in lab.log.read_text()  # a warning that kernels print


def test_formgrader_grades_and_shows_a_submission(lab: Lab, page: Any, shots: Path) -> None:
    """The instructor opens formgrader in JupyterLab, grades, makes feedback, and reads."""
    from playwright.sync_api import expect

    student, work = 'to_be_graded', lab.course / 'autograder' / '_work'
    folder = work / 'submitted' / student / ASSIGNMENT
    folder.mkdir(parents=True)
    (folder / NOTEBOOK).write_bytes((lab.course / 'lesson' / NOTEBOOK).read_bytes())
    page.goto(lab.url())
    choose(page, 'Nbgrader', 'Formgrader')
    formgrader = page.frame_locator('iframe[src*="formgrader"]')
    assignment = formgrader.locator('tr', has_text=ASSIGNMENT)
    assignment.locator('.num-submissions a').click(timeout=OPEN_MS)
    row = formgrader.locator('tr', has_text=student)
    expect(row.locator('.status')).to_have_text('needs autograding', timeout=OPEN_MS)

    row.locator('.autograde a').click()
    answer = formgrader.locator('.modal:visible')
    expect(answer).to_contain_text('Successfully autograded', timeout=CELL_MS)
    answer.get_by_role('button', name='OK').click()
    expect(answer).to_be_hidden()
    expect(row.locator('.score')).to_have_text('50 / 55', timeout=OPEN_MS)
    page.screenshot(path=shots / 'scores.png')
    row.locator('.generate-feedback a').click()
    expect(answer).to_contain_text('Successfully generated feedback', timeout=CELL_MS)
    feedback = work / 'feedback' / student / ASSIGNMENT / NOTEBOOK.replace('.ipynb', '.html')
    assert 'Checks: temperature publisher' in feedback.read_text('utf-8')
    assert page.errors == []

    name = NOTEBOOK.removesuffix('.ipynb')
    page.goto(f'{lab.address}formgrader/gradebook/{ASSIGNMENT}/{name}')
    page.locator('tbody tr .name a:visible').last.click(timeout=OPEN_MS)
    expect(page.locator('body')).to_contain_text('It publishes once per second')
    page.screenshot(path=shots / 'submission.png', full_page=True)


def test_check_notices_an_edited_cell_that_was_not_run(lab: Lab, page: Any, shots: Path) -> None:
    """JupyterLab saves the edited cell, but the check reads the older file of the node."""
    from playwright.sync_api import expect

    folder = lab.course / 'edited'
    folder.mkdir()
    cells = [
        {'cell_type': 'code', 'source': source, 'metadata': {}, 'outputs': []}
        for source in (
            'from roslab import check',
            '%%node talker\n# the first text\n',
            "check('talker')",
        )
    ]
    metadata = {'kernelspec': {'name': 'ros2_jazzy', 'display_name': 'ROS 2 Jazzy'}}
    notebook = {'cells': cells, 'metadata': metadata, 'nbformat': 4, 'nbformat_minor': 4}
    path = folder / 'edited.ipynb'
    path.write_text(json.dumps(notebook), encoding='utf-8')
    open_notebook(lab, page, 'edited/edited.ipynb')
    choose(page, 'Run', 'Run All Cells')
    checked = cell_with(page, "check('talker')")
    wait_until_run(checked)
    shown = checked.locator('.jp-Cell-outputArea')
    expect(shown).to_contain_text('Judged: talker.py, saved')
    expect(shown).to_contain_text('by In [2]')
    expect(shown).not_to_contain_text('is older than its cell')

    cell_with(page, 'the first text').locator('.cm-line').last.click()
    page.keyboard.type('# the second text')
    unsaved = page.locator('.lm-TabBar-tab.jp-mod-dirty')
    expect(unsaved).to_have_count(1)
    expect(unsaved).to_have_count(0, timeout=OPEN_MS)
    checked.locator('.cm-line').last.click()
    page.keyboard.press('Control+Enter')
    expect(shown).to_contain_text('talker.py is older than its cell', timeout=CELL_MS)
    checked.screenshot(path=shots / 'edited.png')
    assert page.errors == []
