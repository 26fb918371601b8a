"""Students and instructors see different parts of nbgrader, and terminals know the course."""

from conftest import ASSIGNMENT
from lab_page import CELL_MS, choose, OPEN_MS, open_notebook
import pytest

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

LESSON = f'notebooks/{ASSIGNMENT}/temperature_monitor.ipynb'
CREATE = '.jp-SideBar [title*="Create Assignment"], .jp-SideBar [data-id*="create_assignment"]'


def offered(page):
    """Return the visible parts of nbgrader: menu entries, a panel, a button."""
    page.locator('.lm-MenuBar-itemLabel', has_text='Nbgrader').click()
    labels = page.locator('.lm-Menu-itemLabel')
    labels.filter(has_text='Assignment List').wait_for(timeout=OPEN_MS)
    found = {text for text in labels.all_inner_texts() if text}
    page.keyboard.press('Escape')
    if page.locator(CREATE).count():
        found.add('Create Assignment')
    if page.get_by_text('Validate', exact=True).count():
        found.add('Validate')
    return found


def test_students_see_nothing_that_is_for_instructors(students_lab, page, shots):
    """The list of assignments remains, for a course that has an exchange, and Validate."""
    open_notebook(students_lab, page, LESSON)
    page.screenshot(path=shots / 'students.png')

    assert offered(page) == {'Assignment List', 'Validate'}


def test_instructors_see_all_of_it(lab, page, shots):
    """Instructors grade the written question in formgrader."""
    open_notebook(lab, page, LESSON)
    page.screenshot(path=shots / 'instructors.png')

    instructors = {'Formgrader', 'Course List', 'Create assignment', 'Create Assignment'}
    assert {'Assignment List', 'Validate', *instructors} <= offered(page)


def test_a_terminal_knows_the_course(lab, page, shots):
    """It opens in a lesson's folder, and finds ros2 and the targets of the Makefile."""
    open_notebook(lab, page, LESSON)
    choose(page, 'File', 'New Launcher')
    page.locator('.jp-LauncherCard', has_text='Terminal').click()
    screen = page.locator('.jp-Terminal .xterm-screen')
    screen.click(timeout=OPEN_MS)
    # The program ends at once, because its parameter is refused: no process is left behind.
    for line in (
        'basename "$PWD" > said.txt',
        'ros2 pkg executables temp_monitor_pkg >> said.txt',
        'make publisher ARGS="--ros-args -p rate_hz:=0.0" >> said.txt; echo done >> said.txt',
    ):
        page.keyboard.type(f'{line}\n')
    said = lab.course / 'notebooks' / ASSIGNMENT / 'said.txt'
    for _ in range(CELL_MS // 200):
        if said.is_file() and 'done' in said.read_text():
            break
        page.wait_for_timeout(200)
    page.screenshot(path=shots / 'terminal.png')

    lines = said.read_text().splitlines()
    assert lines[:3] == [
        ASSIGNMENT,
        'temp_monitor_pkg temp_publisher',
        'temp_monitor_pkg temp_subscriber',
    ]
    assert any('rate_hz' in line and 'FATAL' in line for line in lines[3:])
