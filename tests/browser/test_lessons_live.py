"""
Work through lessons as a student does, in JupyterLab in a headless Chromium.

    make test-browser ARGS='-k lessons_live'
"""

from pathlib import Path
import re
from typing import Any

from conftest import Lab
from lab_page import (
    CELL_MS,
    cell_with,
    choose,
    open_notebook,
    run_all,
    solved,
    wait_until_run,
    WITHOUT_WORDS,
)
import pytest

pytestmark = [
    *(pytest.mark.browser, pytest.mark.ros, pytest.mark.slow),
    pytest.mark.usefixtures('own_kernels'),
]

SHORT_MS = 10_000

POINTS = 'polyline => polyline.getAttribute("points")'
NOTHING_RUNS = """() => ![...document.querySelectorAll('.jp-InputPrompt')]
    .some(prompt => prompt.textContent.includes('*'))"""
MOVED = """([cell, before]) =>
    cell.querySelector('polyline').getAttribute('points') !== before"""
GROUPS = 'inputs => inputs.map(input => input.name)'


def picture(inside: Any, words: str) -> Any:
    """
    Return the picture whose accessible name matches.

    :param words: a regular expression; Playwright would read a slash in it as its end
    """
    return inside.get_by_role('img', name=re.compile(words.replace('/', '.')))


def test_quick_tour_moves_warns_and_asks(lab: Lab, page: Any, shots: Path) -> None:
    """The curve grows while no cell runs, and warnings appear below the monitor's cell."""
    from playwright.sync_api import expect

    open_notebook(lab, page, solved(lab, '00_quick_tour'))
    after = cell_with(page, "echo('/temperature_topic')")
    after.locator('.jp-InputArea-editor').click()
    choose(page, 'Run', 'Run All Above Selected Cell')
    drawn = cell_with(page, 'curve = plot(')
    wait_until_run(drawn)
    page.wait_for_function(NOTHING_RUNS, timeout=SHORT_MS)
    before = drawn.locator('polyline').first.evaluate(POINTS)
    page.wait_for_function(MOVED, arg=[drawn.element_handle(), before], timeout=SHORT_MS)
    drawn.screenshot(path=shots / 'plot.png')
    description = 'Plot of /temperature_topic .* above the threshold 30'
    expect(picture(drawn, description)).to_be_visible()
    # The data that the reader opens stay open and keep the focus while the picture moves.
    opener = drawn.locator('summary')
    opener.press('Enter')
    for _ in range(3):
        before = drawn.locator('polyline').first.evaluate(POINTS)
        page.wait_for_function(MOVED, arg=[drawn.element_handle(), before], timeout=SHORT_MS)
    expect(opener).to_be_focused()
    expect(drawn.locator('table')).to_be_visible()
    after.locator('.jp-InputArea-editor').click()
    page.keyboard.press('Control+Enter')
    wait_until_run(after)
    expect(drawn.locator('table')).to_be_visible()
    page.screenshot(path=shots / 'data.png')

    monitor = cell_with(page, 'start(TemperatureSubscriber)')
    warned = re.compile(r'\[WARN\] \[temperature_subscriber\]: .*above the threshold of 30')
    expect(monitor.locator('.jp-Cell-outputArea')).to_contain_text(warned)
    expect(picture(monitor, 'ROS graph .*nobody publishes')).to_be_visible()
    monitor.screenshot(path=shots / 'monitor.png')
    both = '/temperature_publisher --> /temperature_topic .* --> /temperature_subscriber'
    graph = cell_with(page, 'start(TemperaturePublisher')
    expect(picture(graph, both)).to_be_visible()

    run_all(page)
    questions = page.locator('.roslab-quiz').count()
    assert len(set(page.get_by_role('radio').evaluate_all(GROUPS))) == questions > 1
    assert page.evaluate(WITHOUT_WORDS) == []
    assert page.errors == []


def test_cell_that_is_run_too_early_names_the_cell_to_run_first(
    lab: Lab, page: Any, shots: Path
) -> None:
    """A learner who begins in the middle of a lesson is told where to begin."""
    from playwright.sync_api import expect

    open_notebook(lab, page, solved(lab, '00_quick_tour'))
    cell = cell_with(page, 'curve = plot(')
    cell.locator('.jp-InputArea-editor').click()
    page.keyboard.press('Control+Enter')
    shown = cell.locator('.jp-Cell-outputArea')
    expect(shown).to_contain_text('NameError: plot does not exist yet.', timeout=CELL_MS)
    expect(shown).to_contain_text('Run first: ')
    expect(shown).to_contain_text('the cell that begins with: from roslab import')
    cell.screenshot(path=shots / 'too_early.png')
    assert page.errors == []
