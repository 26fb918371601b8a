"""Find calls and names in a learner's code: in a callback, or outside any def."""

from __future__ import annotations

import pytest

from autograder.submission.code.code_places import (
    leaves_out,
    logs_with_python,
    seed_in_callback,
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
    """Other levels and what __init__() logs once do not explain a missing line."""
    assert leaves_out(node(line), ('info',)) == found


@pytest.mark.parametrize(
    ('line', 'names', 'found'),
    [
        ("log.warning('a')", ('warning', 'warn'), True),
        ("lg.warning('a')", ('warning', 'warn'), True),
        ("lg.getLogger().warning('a')", ('warning', 'warn'), True),
        ("log.warning('a'); self.get_logger().warning('a')", ('warning', 'warn'), False),
        ("self.log.warning('a')", ('warning', 'warn'), True),
        ("self.logger.warning('a')", ('warning', 'warn'), False),
        (
            "self.h['a'] = logging.getLogger('x'); self.get_logger().warning('a')",
            ('warning', 'warn'),
            False,
        ),
        ("log.info('a')", ('info',), False),
    ],
)
def test_loggers_of_python_are_told_from_those_of_nodes(line, names, found):
    """A logger of Python is named only if nothing else logs at that level."""
    assert logs_with_python(node(line), names) is found


@pytest.mark.parametrize(
    ('line', 'call', 'found'),
    [
        ('random.seed(7)', '', 'seed'),
        ('rng = random.Random(7)', '', 'Random'),
        ('random.seed(SEED)', 'SEED = 7\n', 'seed'),
        ('self.draw()', '    def draw(self):\n        np.random.default_rng(3)\n', 'default_rng'),
        ('pass', 'def set_up():\n    random.seed(7)\nset_up()\n', ''),
        ('random.seed()', '', ''),
        ('random.seed(self.number)', '', ''),
    ],
)
def test_seed_counts_where_a_callback_comes_to_it(line, call, found):
    """A seed counts only in code that a callback reaches."""
    assert seed_in_callback(node(line, call)) == found
