"""Find calls and names in a learner's code: in a callback, or outside any def."""

import pytest

from autograder.submission.code.code_places import (
    leaves_out,
    logs_with_python,
)

NODE = (
    'import logging as lg\n'
    "log = lg.getLogger('n')\n"
    'class N(Node):\n'
    '    def __init__(self):\n'
    "        self.get_logger().info('ready', once=True)\n"
    '        random.seed(1)\n'
    '        self.create_timer(1.0, self.tick)\n'
    '    def tick(self):\n'
    '        {}\n'
)


def node(line: str, call: str = '') -> dict[str, str]:
    """Return the file of a node with a line in its callback."""
    return {'n.py': NODE.format(line) + call}


@pytest.mark.parametrize(
    ('line', 'found'),
    [
        ("self.get_logger().info('a', throttle_duration_sec=5.0)", 'throttle_duration_sec'),
        ("self.get_logger().info('a', skip_first=True)", 'skip_first'),
        ("self.get_logger().info('a', once=False)", ''),
        ("self.get_logger().info('a')", ''),
        ("self.get_logger().info('a', once=True); self.get_logger().info('b')", ''),
        ("self.get_logger().warning('a', once=True)", ''),
        ('pass', ''),
    ],
)
def test_lines_are_left_out_if_all_of_a_level_are_told_to(line, found):
    """What is said once in __init__() explains nothing, and neither does another level."""
    assert leaves_out(node(line), 'info') == found


@pytest.mark.parametrize(
    ('line', 'names', 'found'),
    [
        ("log.warning('a')", 'warning', True),
        ("lg.warning('a')", 'warning', True),
        ("lg.getLogger().warning('a')", 'warning', True),
        ("log.warning('a'); self.get_logger().warning('a')", 'warning', False),
        ("self.log.warning('a')", 'warning', True),
        ("self.logger.warning('a')", 'warning', False),
        (
            "self.h['a'] = logging.getLogger('x'); self.get_logger().warning('a')",
            'warning',
            False,
        ),
        ("log.info('a')", 'info', False),
    ],
)
def test_loggers_of_python_are_told_from_those_of_nodes(line, names, found):
    """A logger of Python is named only if nothing else logs at that level."""
    assert logs_with_python(node(line), names) is found
