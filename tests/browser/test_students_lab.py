"""Students and instructors see different parts of nbgrader, and terminals know the course."""

from collections.abc import Iterable, Mapping
import json
from pathlib import Path
import shutil
from typing import Any

from conftest import ASSIGNMENT, Lab
from lab_page import CELL_MS, choose, OPEN_MS, open_notebook, solved
import pytest

from autograder.submission.cells import parse_cell
from tests.browser.nbgrader_parts import offered

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

PACKAGE = '10_package_of_your_own'
LESSON = f'notebooks/{ASSIGNMENT}/temperature_monitor.ipynb'


def test_students_see_nothing_that_is_for_instructors(students_lab, page, shots):
    """Only Validate and the list of assignments remain, for courses that have an exchange."""
    open_notebook(students_lab, page, LESSON)
    page.screenshot(path=shots / 'students.png')

    assert offered(page) == {'Assignment List', 'Validate'}


def test_instructors_see_all_of_it(lab, page, shots):
    """Instructors grade the written question in formgrader."""
    open_notebook(lab, page, LESSON)
    page.screenshot(path=shots / 'instructors.png')

    instructors = {'Formgrader', 'Course List', 'Create assignment', 'Create Assignment'}
    assert {'Assignment List', 'Validate', *instructors} <= offered(page)


def open_terminal(lab: Lab, page: Any) -> None:
    """Open a terminal from the launcher, so that it begins in the folder of the lesson."""
    choose(page, 'File', 'New Launcher')
    page.locator('.jp-LauncherCard', has_text='Terminal').click()
    page.locator('.jp-Terminal .xterm-screen').click(timeout=OPEN_MS)


def type_in(page: Any, lines: Iterable[str], said: Path) -> list[str]:
    """
    Type commands into the terminal, and return the lines of a file when it ends with ``done``.

    :param said: the file to which the commands write
    """
    for line in (*lines, 'echo done >> said.txt'):
        page.keyboard.type(f'{line}\n')
    for _ in range(CELL_MS // 200):
        if said.is_file() and said.read_text().endswith('done\n'):
            break
        page.wait_for_timeout(200)
    return said.read_text().splitlines()


def test_a_terminal_knows_the_course(lab: Lab, page: Any, shots: Path) -> None:
    """The terminal opens in the lesson's folder, and finds ros2 and the Makefile's targets."""
    open_notebook(lab, page, LESSON)
    open_terminal(lab, page)
    # The program ends at once, because its parameter is refused: no process is left behind.
    commands = (
        'basename "$PWD" > said.txt',
        'ros2 pkg executables temp_monitor_pkg >> said.txt',
        'make publisher ARGS="--ros-args -p rate_hz:=0.0" >> said.txt',
    )
    lines = type_in(page, commands, lab.course / 'notebooks' / ASSIGNMENT / 'said.txt')
    page.screenshot(path=shots / 'terminal.png')

    assert lines[:3] == [
        ASSIGNMENT,
        'temp_monitor_pkg temp_publisher',
        'temp_monitor_pkg temp_subscriber',
    ]
    assert any('rate_hz' in line and 'FATAL' in line for line in lines[3:])


def commands_of(cells: Mapping[str, str], name: str) -> list[str]:
    """Return the commands of a cell as they are typed in a terminal, without exclamation marks."""
    joined = cells[name].replace('\\\n', ' ')
    return [line.removeprefix('!') for line in joined.splitlines()]


def test_a_package_is_made_in_a_terminal(lab: Lab, page: Any, shots: Path) -> None:
    """The commands of lesson 10 also work when they are typed; an editor saves the files."""
    path = solved(lab, PACKAGE)
    notebook = json.loads((lab.course / path).read_text(encoding='utf-8'))
    cells = {cell['id']: ''.join(cell['source']) for cell in notebook['cells']}
    folder = (lab.course / path).parent
    shutil.rmtree(folder / 'ros_ws', ignore_errors=True)  # of another test
    open_notebook(lab, page, path)
    open_terminal(lab, page)
    create = [*commands_of(cells, 'part-1-workspace'), *commands_of(cells, 'part-1-create')]
    created = type_in(page, create, folder / 'said.txt')
    (folder / 'said.txt').unlink()
    package = folder / 'ros_ws' / 'src' / 'my_robot_pkg'
    for name in ('part-2-talker', 'part-2-listener', 'part-2-setup'):
        file = parse_cell(cells[name])
        inside = package / 'my_robot_pkg' if file.kind == 'node' else package
        (inside / file.path).write_text(file.body, encoding='utf-8')
    build, _, run = commands_of(cells, 'part-2-run')
    said = type_in(page, [f'{build} > said.txt', f'{run} >> said.txt 2>&1'], folder / 'said.txt')
    page.screenshot(path=shots / 'package.png')

    assert created == ['done']
    assert any('Publishing: "Hello World: 0"' in line for line in said), said
