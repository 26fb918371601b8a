"""roslab in real notebook kernels: live cells, node cells, re-runs and checks."""

import re

import live_kernels
from live_kernels import execute, Kernel, streams, TALKER
import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]

kernel, kernel_to_share = live_kernels.kernel, live_kernels.kernel_to_share
new_kernel = live_kernels.new_kernel
kernel_of_module = live_kernels.kernel_of_module
kernel_with_node = live_kernels.kernel_with_node


def test_notebook_with_live_cells_executes_without_stderr(tmp_path):
    """A node that one cell starts is heard in the next cell, and a re-run replaces it."""
    begin = 'node = start(Talker); heard = listen("chatter", String)'
    notebook = execute(
        [TALKER, begin, 'print(len(heard.wait(3)) >= 3)', begin, 'heard.wait(3); list(nodes())'],
        tmp_path,
    )

    assert streams(notebook.cells[2]) == 'True\n'
    assert notebook.cells[4].outputs[-1].data['text/plain'] == "['talker']"
    assert not [cell.source for cell in notebook.cells if streams(cell, 'stderr')]


def test_kernel_loads_the_error_hints_and_starts_without_them(kernel, tmp_path):
    """The kernel starts with the extension, and a missing extension does not stop it."""
    loaded = kernel.run('"roslab.error_hints" in get_ipython().extension_manager.loaded')
    assert loaded.value == 'True'

    without = Kernel(tmp_path, '--ext=roslab.no_such_guide')
    assert without.run('1 + 1').value == '2'
    without.shut_down()


@pytest.mark.parametrize(
    ('cell', 'words'),
    [
        ('raise NotImplementedError', 'this is not written yet'),
        ('x = 3\n%%node talker', '%%node has to be the first line'),
        ('roslab.stop("nobody")', "No node 'nobody' was started"),
        ('raise KeyboardInterrupt', 'the cell was interrupted'),
        ('raise roslab.errors.RoslabError("look here")', 'look here'),
    ],
)
def test_explain_repeats_the_hint_that_was_shown_last(kernel_of_module, cell, words):
    """An error shown as a sentence counts as the last error, like one with a traceback."""
    kernel_of_module.run('{}["older"]')
    shown = kernel_of_module.run(cell)

    said = kernel_of_module.run('roslab.explain()').text
    assert shown.error
    assert words in ' '.join(said.split())
    assert 'older' not in said


def test_node_cell_is_saved_run_and_exported(tmp_path):
    body = TALKER.replace('from roslab import *', '').replace('import rclpy\n', 'import sys\n')
    notebook = execute(
        ['import roslab', f'%%node talker\n{body}', 'roslab.start(Talker); Talker.__module__'],
        tmp_path,
    )
    saved = tmp_path / 'ros_ws/src/temp_monitor_pkg/temp_monitor_pkg/talker.py'

    assert saved.read_text().strip() == body.strip()
    assert 'temp_monitor_pkg/talker.py' in streams(notebook.cells[1])
    assert 'defined Talker' in streams(notebook.cells[1])
    assert notebook.cells[2].outputs[0].data['text/plain'] == "'talker'"


def test_bare_main_call_does_not_block_the_cell(tmp_path):
    body = 'def main():\n    import time\n    time.sleep(1e6)\n\nmain()'
    notebook = execute(['import roslab', f'%%node talker\n{body}'], tmp_path)

    assert 'Line 6 of the cell calls main()' in streams(notebook.cells[1])


@pytest.mark.parametrize(
    ('cell', 'said'),
    [
        ('%%node ../x\npass', '../x'),
        ('%%node /etc/x\npass', '/etc/x'),
        ('%%node rclpy\npass', 'a different name'),
        ('%%node json\npass', 'a different name'),
        ('%%node {x}\npass', '{x}'),
        ('%%node\npass', '%%node temp_publisher'),
        ('%%rosmsg temperature\nint64 x', 'capital letter'),
        ('%%rosmsg Num/../../x\nint64 x', 'letters'),
        ('%%rospkg make.py\nx', 'package.xml'),
        ('%%node x\nx = (', "'(' was never closed"),
        ('%%node stub\n# YOUR CODE HERE\nraise NotImplementedError()', 'not written yet'),
        ('%%rosmsg Temperature\n# YOUR CODE HERE', 'not written yet'),
        ('%%rospkg package.xml\n<!-- YOUR CODE HERE -->', 'not written yet'),
        ('%%rosmsg Temperature', 'not written yet'),
    ],
)
def test_refused_cell_says_why_in_one_short_text(kernel_of_module, cell, said):
    outputs = kernel_of_module.run(cell)

    shown = '\n'.join(outputs.error['traceback'])
    assert said in shown
    assert 'roslab/' not in shown
    assert len(shown.splitlines()) <= 4
    assert outputs.streams['stderr'] == ''


def test_node_does_not_hide_roslab_names(kernel):
    """A learner's own `check` does not replace the `check` that the notebook needs."""
    kernel.run('from roslab import *; import roslab')
    outputs = kernel.run('%%node mine\ndef check():\n    return 1\ndef other():\n    return 2')

    assert 'this is roslab.check' in outputs.text
    assert kernel.run('check is roslab.check, other()').value == '(True, 2)'


def test_stub_in_a_constructor_is_shown_without_frames_of_roslab(kernel):
    kernel.run('from roslab import *; from rclpy.node import Node')
    stub = 'class Mine(Node):\n    def __init__(self):\n        raise NotImplementedError()\n'
    outputs = kernel.run(f'{stub}start(Mine)')
    shown = '\n'.join(outputs.error['traceback'])

    assert outputs.error['ename'] == 'NotImplementedError'
    assert 'start(Mine) created no node' in shown
    assert re.search(r'Cell In\[\d+\], line 3, in __init__', shown)
    assert 'Replace that line' in shown
    assert 'session.py' not in shown


def test_node_without_a_name_is_an_error_of_the_node_class(kernel):
    kernel.run('from roslab import *; from rclpy.node import Node')
    named = 'class Mine(Node):\n    def __init__(self):\n        super().__init__()\n'
    outputs = kernel.run(f'{named}start(Mine)')

    assert 'Node.__init__() missing 1 required' in '\n'.join(outputs.error['traceback'])


@pytest.mark.parametrize(
    ('code', 'said'),
    [
        ('rclpy.init()', 'ROS 2 runs in this notebook already'),
        ('def main():\n    rclpy.init()\nmain()', 'ROS 2 runs in this notebook already'),
        ('rclpy.spin(node)', 'start(...) spins it in the background'),
        ('rclpy.spin_once(node)', 'start(...) spins it in the background'),
    ],
)
def test_code_of_a_program_typed_in_a_cell_is_answered_in_one_line(kernel_with_node, code, said):
    """A call that would restart ROS or spin the node is refused, and the node keeps running."""
    outputs = kernel_with_node.run(code)

    assert said in outputs.error['traceback'][0]
    assert len(outputs.error['traceback']) == 1
    after = kernel_with_node.run('n = node.count; wait_until(lambda: node.count > n, 5)')
    assert after.value == 'True'


def test_error_in_a_node_cell_names_the_line_of_the_cell(kernel):
    """A traceback counts the magic line as line 1, as the checks do."""
    kernel.run('import roslab')
    kernel.run('%%node broken\ndef f():\n    return 1 / 0')
    shown = re.sub(r'\x1b\[[\d;]*m', '', '\n'.join(kernel.run('f()').error['traceback']))

    assert 'Cell In[2], line 3, in f()' in shown
    assert 'return 1/0' in shown.replace(' / ', '/')


@pytest.mark.parametrize(
    ('cell', 'error'),
    [
        ('x = = 1', 'SyntaxError'),
        ('if True:\nx = 1', 'IndentationError'),
        ('%%node noisy\nclass Noisy(Nod):\n    pass', 'NameError'),
        ('%%node noisy\nimport rclpyy', 'ModuleNotFoundError'),
    ],
)
def test_mistake_in_a_cell_is_shown_without_frames_of_ipython(kernel_of_module, cell, error):
    kernel_of_module.run('import roslab')
    raised = kernel_of_module.run(cell).error
    shown = '\n'.join(raised['traceback'])

    assert raised['ename'] == error
    assert 'run_cell_magic' not in shown
    assert 'site-packages' not in shown


def test_stop_all_leaves_no_node_and_no_subscription(kernel):
    kernel.run(TALKER)
    kernel.run('node = start(Talker); heard = listen("chatter", String); heard.wait(2)')
    kernel.run('stop_all(); probe = rclpy.create_node("probe")')

    assert kernel.run('probe.get_node_names()').value == "['probe']"
    assert kernel.run('heard').value.endswith('stopped>')
    kernel.run('heard.clear(); node = start(Talker)')
    assert kernel.run('len(heard.wait(2)) >= 2').value == 'True'


def test_rclpy_shutdown_in_a_cell_can_be_followed_by_a_start(kernel):
    kernel.run(TALKER)
    kernel.run('node = start(Talker); rclpy.shutdown()')
    outputs = kernel.run('node = start(Talker); wait_until(lambda: node.count > 2)')

    assert outputs.error is None
    assert outputs.value == 'True'


def test_check_without_saved_files_says_what_to_run(kernel):
    kernel.run('from roslab import check')
    outputs = kernel.run("report = check('temperature_publisher')")

    assert 'first run the cells of the exercise' in outputs.text
    assert outputs.error is None
    assert kernel.run('bool(report)').value == 'False'


def test_check_is_shown_once_as_html_in_a_frontend(kernel):
    """A frontend gets one table, and not a second one as the value of the cell."""
    kernel.run('from roslab import check')
    outputs = kernel.run("report = check('temperature_publisher')\nreport", cell_id='a')
    again = kernel.run('report', cell_id='b')

    assert len(outputs.data) == 1
    assert '<strong>' in outputs.data[0]['text/html']
    assert len(again.data) == 1
    assert outputs.text == ''
