"""Outputs of cells in JupyterLab are accessible, on a light and on a dark page."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from accessibility import violations
from conftest import Lab
from lab_page import choose, open_notebook, run_all, solved
import pytest

from autograder.simulated import TopicRecord
from roslab.timeline_picture import timeline

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

OUTPUTS = '.jp-OutputArea-output'
DARK = 'body[data-jp-theme-light="false"]'
CURSOR_X = """() => {
    const cursor = document.querySelector('[data-cursor]').getBoundingClientRect();
    return (cursor.left + cursor.right) / 2;
}"""
THUMB_PX = 16


def test_outputs_of_a_lesson_are_accessible(lab: Lab, browser: Any, shots: Path) -> None:
    """The outputs are pictures with their data, questions and log lines."""
    context = browser.new_context(bypass_csp=True, viewport={'width': 1360, 'height': 900})
    page = context.new_page()
    open_notebook(lab, page, solved(lab, '00_quick_tour'))
    run_all(page)
    data = page.locator(f'{OUTPUTS} details', has_text='Data of this picture')
    data.first.evaluate('one => { one.open = true }')
    found = {'light': violations(page, of=OUTPUTS)}
    data.first.scroll_into_view_if_needed()
    page.screenshot(path=shots / 'light.png')
    choose(page, 'Settings', 'Theme', 'JupyterLab Dark')
    page.locator(DARK).wait_for(state='attached')
    found['dark'] = violations(page, of=OUTPUTS)
    data.first.scroll_into_view_if_needed()
    page.screenshot(path=shots / 'dark.png')
    pictures = data.count()
    context.close()

    assert pictures == 3
    assert found == {'light': [], 'dark': []}


@pytest.mark.parametrize('width', [400, 1400])
def test_slider_is_below_the_moment_that_it_shows(page: Any, shots: Path, width: int) -> None:
    """On a phone too; the arrow keys go from message to message."""
    times = (0.5, 2.0, 3.5, 9.0)
    run = TopicRecord(
        '/a', 'std_msgs/msg/String', times, tuple({'data': 'x'} for _ in times), 10.0
    )
    page.set_viewport_size({'width': width, 'height': 300})
    page.set_content(timeline(SimpleNamespace(listeners=[run]))._repr_html_())
    slider, said = page.get_by_role('slider'), page.get_by_role('status')
    box = slider.bounding_box()
    length = box['width'] - THUMB_PX

    for time in times:  # the axis goes from 0 to the last message
        slider.click(position={'x': THUMB_PX / 2 + length * time / 9.0, 'y': box['height'] / 2})
        assert said.inner_text().startswith(f'{time:.2f} s')
        left = slider.bounding_box()['x'] + THUMB_PX / 2  # a click scrolls a narrow page
        assert page.evaluate(CURSOR_X) == pytest.approx(left + length * time / 9.0, abs=1.5)
    page.screenshot(path=shots / f'slider-{width}.png')
    for time in reversed(times[:-1]):
        slider.press('ArrowLeft')
        assert said.inner_text().startswith(f'{time:.2f} s')
    assert page.errors == []
