"""A solution cell that has lost its first line is refused, instead of hanging in main()."""

import live_kernels
import nbformat
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.notebooks]

kernel = live_kernels.kernel_of_module

PROGRAM = """import rclpy
from rclpy.node import Node


def main(args=None):
    rclpy.init(args=args)
    node = Node('patient')
    rclpy.spin(node)


if __name__ == '__main__':
    main()
"""
SENTENCE = (
    'NodeLineMissingError: this cell is a whole program, and the notebook would wait for its '
    'main() forever. It was not run. Write this as its first line: %%node {}'
)


def said(kernel, code, **more):
    """Return all that a refused cell shows."""
    return kernel.run(code, **more).error['traceback']


@pytest.fixture
def lesson(kernel):
    """Return a function that saves a notebook of one cell in the kernel's folder."""
    folder = kernel.run('import os; os.getcwd()').value.strip("'")
    path = f'{folder}/lesson.ipynb'

    def save(source, identifier='a-cell', **marks):
        cell = nbformat.v4.new_code_cell(source, id=identifier)
        cell.metadata['nbgrader'] = marks
        nbformat.write(nbformat.v4.new_notebook(cells=[cell]), path)

    yield save
    kernel.run(f'os.unlink({path!r})')


@pytest.mark.parametrize(
    'program',
    [
        PROGRAM,
        PROGRAM.replace("__name__ == '__main__'", '"__main__" == __name__'),
        PROGRAM.partition('if __name__')[0] + 'main()',
        PROGRAM.replace('rclpy.spin(node)', 'while rclpy.ok():\n        node.get_clock()'),
    ],
)
def test_program_in_an_ordinary_cell_is_not_run(kernel, program):
    """No part of the cell is executed, and ROS is not started."""
    assert said(kernel, f'hung = True\n{program}') == [SENTENCE.format('my_node')]
    assert kernel.run('"hung" in globals(), __import__("rclpy").ok()').value == '(False, False)'


@pytest.mark.parametrize(
    ('grade_id', 'name'),
    [('talker', 'talker'), ('temperature_publisher', 'temp_publisher'), ('unknown', 'my_node')],
)
def test_cell_of_an_exercise_gets_its_own_first_line(kernel, lesson, grade_id, name):
    """The cell keeps its grade id when its first line is lost."""
    lesson(PROGRAM, grade_id=grade_id)

    assert said(kernel, PROGRAM) == [SENTENCE.format(name)]


def test_notebook_that_was_saved_before_tells_the_lost_line(kernel, lesson):
    """Node cells that are not exercises have no grade id."""
    lesson(f'%%node often_seen\n{PROGRAM}')

    assert said(kernel, PROGRAM, cell_id='a-cell') == [SENTENCE.format('often_seen')]


@pytest.mark.parametrize(
    'cell',
    [
        "if __name__ == '__main__':\n    print('no ROS here')",
        '%%node whole\n' + PROGRAM,
        'import rclpy\nrclpy.ok()',
        'def main(): pass\nmain()',
        'import rclpy\ndef main(): return rclpy.ok()\nmain()',
    ],
)
def test_other_cells_run_as_before(kernel, cell):
    """Node cells and cells that are not ROS programs run."""
    assert kernel.run(cell).error is None
