"""Outputs of cells in JupyterLab are accessible, on a light and on a dark page."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from accessibility import violations
from conftest import ASSIGNMENT, Lab
from lab_page import choose, open_notebook, run_all, solved
import pytest

from autograder.authoring.student_bundle import answer_files
from autograder.files import write_atomically
from autograder.layout import Layout
from autograder.simulated import TopicRecord
from roslab.timeline_picture import timeline

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

OUTPUTS = '.jp-OutputArea-output'
SHOWN = {
    'notebooks/START_HERE.ipynb': ('next: lesson',),
    '00_quick_tour': ('Plot of',),
    '01_node_life': ('ROS graph', 'Passed:'),
    '02_spinning': ('Robot at', 'Callbacks in', 'Timeline of'),
    '03_topics': ('ROS graph', 'Show me a worked answer'),
    '04_messages': ('Passed:',),
    '05_quality_of_service': ('Reliability and durability', 'Robot at', 'Timeline of'),
    '06_managed_lifecycle': ('States of', 'Passed:'),
    '08_what_went_wrong': ('ROS graph',),
    '09_check_your_understanding': ('Passed:',),
    '10_package_of_your_own': ('Passed:',),
    '11_testing': ('Plot of', 'Passed:'),
    ASSIGNMENT: ('✗ Failed:', 'log lines', 'Plot of', 'ROS graph'),
}
"""Words in the outputs of each notebook."""
FOR_07 = (('PERIOD_S = 1.0', 'PERIOD_S = 0.5'), ("logs().at_level('WARN')[-1].message", 'logs()'))
OPEN = 'all => all.forEach(one => { one.open = true })'
PANEL = '.jp-WindowedPanel-outer'
HEIGHT = 'document.querySelector(".jp-WindowedPanel-viewport").scrollHeight'
IS_LIGHT = {
    'Light': 'body[data-jp-theme-light="true"]',
    'Dark': 'body[data-jp-theme-light="false"]',
}
CURSOR_X = """() => {
    const cursor = document.querySelector('[data-cursor]').getBoundingClientRect();
    return (cursor.left + cursor.right) / 2;
}"""
THUMB_PX = 16


@pytest.fixture(scope='module')
def completed(course: Path) -> Path:
    """Return the course with worked answers, a failed check and a table of log lines."""
    for name, data in answer_files(Layout(course)).items():
        write_atomically(course / name, data)
    lesson = course / 'solutions' / ASSIGNMENT / 'temperature_monitor.ipynb'
    content = lesson.read_text(encoding='utf-8')
    for old, new in FOR_07:
        assert content.count(old) == 1, old
        content = content.replace(old, new)
    write_atomically(lesson, content.encode())
    return course


def show_all(page: Any) -> None:
    """Make the page as high as the notebook, because axe ignores everything outside the page."""
    page.add_style_tag(content='body { height: 100vh }')  # JupyterLab's body has no height
    page.set_viewport_size({'width': 1360, 'height': page.evaluate(HEIGHT) + 300})
    page.wait_for_function(f'{HEIGHT} < document.querySelector("{PANEL}").clientHeight')


def use_theme(page: Any, theme: str) -> None:
    """Change the theme, wait until JupyterLab shows the page again, and scroll to the top."""
    if not page.locator(IS_LIGHT[theme]).count():
        choose(page, 'Settings', 'Theme', f'JupyterLab {theme}')
    page.locator(IS_LIGHT[theme]).wait_for(state='attached')
    page.locator('.jp-LabShell').wait_for()
    page.locator('#jupyterlab-splash').wait_for(state='detached')
    page.locator(PANEL).evaluate('panel => { panel.scrollTop = 0 }')


@pytest.mark.parametrize('lesson', SHOWN)
def test_outputs_are_accessible(
    completed: Path, lab: Lab, own_kernels: None, browser: Any, shots: Path, lesson: str
) -> None:
    """The test opens the data of pictures and the worked answers."""
    context = browser.new_context(bypass_csp=True, viewport={'width': 1360, 'height': 900})
    page = context.new_page()
    open_notebook(lab, page, solved(lab, lesson) if lesson[0].isdigit() else lesson)
    run_all(page)
    page.locator(f'{OUTPUTS} details').evaluate_all(OPEN)
    show_all(page)
    found = {}
    for theme in ('Light', 'Dark'):
        use_theme(page, theme)
        found[theme] = violations(page, of=OUTPUTS)
        for number, words in enumerate(SHOWN[lesson]):
            shown = page.locator(OUTPUTS, has_text=words).last
            shown.screenshot(path=shots / f'{number}-{theme}.png')
    context.close()

    assert found == {'Light': [], 'Dark': []}


@pytest.mark.parametrize('width', [400, 1400])
def test_slider_is_below_the_moment_that_it_shows(page: Any, shots: Path, width: int) -> None:
    """The test uses a wide page and a phone; the arrow keys move from message to message."""
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
