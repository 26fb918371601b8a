"""Visible checks in a notebook, which the grader runs in a child process."""

import os
import re

import live_kernels
import nbformat
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

kernel, kernel_to_share = live_kernels.kernel, live_kernels.kernel_to_share

TWICE_A_SECOND = """%%node temp_publisher
import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(Temperature(temperature_value=25.0, unit='Celsius'))

def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperaturePublisher())

if __name__ == '__main__':
    main()
"""
CHECK = "report = check('temperature_publisher')"


def test_check_judges_what_the_saved_node_does(kernel):
    """The table shows passed and failed checks with points and facts, and stderr is empty."""
    kernel.run('from roslab import *')
    kernel.run(TWICE_A_SECOND)
    outputs = kernel.run(CHECK)

    assert '[pass]' in outputs.text
    assert '[FAIL]' in outputs.text
    assert 'observed:' in outputs.text
    assert outputs.streams['stderr'] == ''
    assert kernel.run('0 < report.points < report.max_points, bool(report)').value == (
        '(True, False)'
    )


def test_check_never_runs_the_file_in_the_kernel(kernel, tmp_path):
    """A file that no cell has saved is judged in the child process, and not in the kernel."""
    folder = tmp_path / 'ros_ws' / 'src' / 'temp_monitor_pkg' / 'temp_monitor_pkg'
    folder.mkdir(parents=True)
    (folder / 'temp_publisher.py').write_text('import builtins\nbuiltins.ran_here = True\n')
    kernel.run('import builtins; from roslab import *')
    kernel.run(CHECK)

    assert kernel.run('hasattr(builtins, "ran_here"), report.points == 0').value == '(False, True)'


def test_unfinished_cell_is_named_and_still_checked(kernel):
    kernel.run('from roslab import *')
    kernel.run('%%node temp_publisher\n# YOUR CODE HERE\nraise NotImplementedError()')
    outputs = kernel.run(CHECK)

    assert 'temp_publisher.py is not finished' in outputs.text
    assert outputs.error is None
    assert kernel.run('report.points == 0').value == 'True'


def test_cell_that_was_not_run_is_asked_for(kernel):
    """If another file was saved, the message asks for the cell of the exercise."""
    kernel.run('from roslab import *')
    kernel.run('%%node something_else\npass')

    line = '%%node temp_publisher'
    assert f'Run the cell of the exercise that begins with {line}' in kernel.run(CHECK).text


def test_unknown_exercise_is_named(kernel):
    kernel.run('from roslab import *')
    near, far = kernel.run("check('temperature_publsher')"), kernel.run("check('unheard')")

    assert "Try: check('temperature_publisher')" in near.text
    assert 'temperature_subscriber' in far.text
    assert 'the checker itself' not in near.text + far.text


def test_check_without_a_name_says_which_exercises_there_are(kernel, tmp_path):
    """The message lists the exercises of the notebook, or else all exercises."""
    kernel.run('from roslab import *')
    of_all = ' '.join(kernel.run('report = check()').text.split())
    lesson = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("check('courier')")])
    nbformat.write(lesson, tmp_path / 'lesson.ipynb')
    of_lesson = ' '.join(kernel.run('report = check()').text.split())

    expected = 'check(): expected the name of an exercise, in quotes, got nothing. Try: '
    assert f"{expected}check('check_your_understanding') or check('courier') or" in of_all
    assert f"{expected}check('courier')." in of_lesson


@pytest.mark.parametrize(
    ('call', 'got'),
    [
        (
            'check(TemperaturePublisher)',
            'check(TemperaturePublisher): expected {}the class itself',
        ),
        ('check(main)', 'check(main): expected {}a function'),
        ('check(node)', 'check(TemperaturePublisher object): expected {}a TemperaturePublisher'),
    ],
)
def test_check_of_an_object_names_the_exercise_of_its_file(kernel, call, got):
    """A class, a function of the same cell and a node lead to the name of the exercise."""
    kernel.run('from roslab import *')
    kernel.run(TWICE_A_SECOND)
    kernel.run('import rclpy; rclpy.ok() or rclpy.init(); node = TemperaturePublisher()')
    said = ' '.join(kernel.run(f'report = {call}').text.split())

    assert got.format('the name of an exercise, in quotes, got ') in said
    assert said.endswith("Try: check('temperature_publisher').")


def test_check_of_a_bare_name_asks_for_quotes(kernel):
    kernel.run('from roslab import *')
    error = kernel.run('check(talker)').error

    assert error['ename'] == 'NameError'
    assert error['traceback'] == [
        "NameError: check() takes the name of an exercise in quotes. Write: check('talker')"
    ]


def test_check_says_which_cell_saved_the_judged_file(kernel, tmp_path):
    """A file that changed, or that this kernel did not save, has no cell."""
    kernel.run('from roslab import *')
    kernel.run(TWICE_A_SECOND)
    by_cell = kernel.run(CHECK).text
    file = tmp_path / 'ros_ws/src/temp_monitor_pkg/temp_monitor_pkg/temp_publisher.py'
    os.utime(file, (1_700_000_000, 1_700_000_000))
    by_other = kernel.run(CHECK).text

    assert re.search(r'Judged: temp_publisher.py, saved \d\d:\d\d by In \[2\]\.', by_cell)
    assert re.search(
        r'Judged: temp_publisher.py, saved 1\d Nov \d\d:\d\d by another kernel or program\.',
        by_other,
    )


def test_check_warns_if_the_cell_was_edited_and_not_run(kernel, tmp_path):
    """The saved notebook contains a different text for the cell that saved the file."""
    ran = TWICE_A_SECOND.replace('\n\n', '\n    \n')  # IPython removes blanks from empty lines
    assert ran != TWICE_A_SECOND
    kernel.run('from roslab import *')
    kernel.run(ran)
    path = tmp_path / 'lesson.ipynb'
    found = []
    edited = ran.replace('0.5', '1.0')
    for text, number in ((ran, 2), (edited, 2), (edited, 1)):
        cell = nbformat.v4.new_code_cell(text, execution_count=number)
        cells = [cell, nbformat.v4.new_code_cell(CHECK)]
        nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
        found.append('temp_publisher.py is older than its cell' in kernel.run(CHECK).text)

    # The third notebook is older than the file: its cell has the number of an earlier run.
    assert found == [False, True, False]


def test_file_that_no_cell_makes_any_more_is_named(kernel, tmp_path):
    """The file is judged, but its cell has a new first line, so it would not be handed in."""
    folder = tmp_path / 'ros_ws' / 'src' / 'temp_monitor_pkg' / 'temp_monitor_pkg'
    folder.mkdir(parents=True)
    (folder / 'temp_publisher.py').write_text(TWICE_A_SECOND.partition('\n')[2])
    renamed = TWICE_A_SECOND.replace('%%node temp_publisher', '%%node temp_publishr')
    lesson = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(renamed)])
    nbformat.write(lesson, tmp_path / 'lesson.ipynb')
    kernel.run('from roslab import *')
    first = ' '.join(kernel.run(CHECK).text.split())
    kernel.run(TWICE_A_SECOND)
    then = kernel.run(CHECK)

    assert 'temp_publisher.py is left over: no cell saves it any more' in first
    assert '[pass]' in then.text
    assert 'left over' not in then.text


def test_interrupted_check_leaves_no_process(kernel):
    """An interrupt ends the checker and the sandbox, and the next check works."""
    kernel.run('from roslab import *; import psutil')
    kernel.run(TWICE_A_SECOND)
    outputs = kernel.interrupt_at(f'print("go", flush=True); {CHECK}', 'go')

    assert outputs.error['ename'] == 'KeyboardInterrupt'
    assert kernel.run('psutil.Process().children(recursive=True)').value == '[]'
    assert '[pass]' in kernel.run(CHECK).text


def test_validate_button_fails_on_a_failed_check(monkeypatch, tmp_path):
    """With nbgrader's Validate, a failed check is a failed cell; elsewhere it is a table."""
    monkeypatch.setitem(os.environ, 'NBGRADER_EXECUTION', 'validate')
    validating = live_kernels.Kernel(tmp_path)
    validating.run('from roslab import *')
    validating.run(TWICE_A_SECOND)
    outputs = validating.run(CHECK)
    validating.shut_down()

    assert outputs.error['ename'] == 'RoslabError'
    assert outputs.error['traceback'] == [outputs.error['evalue']], 'only the report is shown'
    assert 'temperature_publisher' in outputs.error['evalue']
    assert '[FAIL]' in outputs.text
