"""Analysis of a learner's code, which ignores comments, strings and invalid Python."""

import pytest

from autograder.submission.code import mistakes
from autograder.submission.code.mistakes import (
    leaves_out,
    logs_with_python,
    pause_in_callback,
)
from autograder.submission.code.program import without_strings
from autograder.submission.code.source_code import Code

LAMBDA = 'node.create_timer(1.0, lambda: time.sleep(1.0))'
OTHER = 'class M(Node):\n    def tick(self):\n        pass\n'


def body(callback, made='self.create_timer(1.0, self.tick)'):
    """Return the code of a node with one callback, whose body begins in line 5."""
    code = f'class N(Node):\n    def __init__(self):\n        {made}\n    def tick(self):\n'
    return f'{code}        {callback}\n'


class TestTexts:
    @pytest.mark.parametrize(
        ('code', 'left'),
        [
            ('a = 1  # time.sleep(1)\n', 'a = 1'),
            ("'time.sleep(1)'\na = 1\n", '\na = 1'),
            ('"""one\ntime.time()\n"""\na = 1\n', 'a = 1'),
            ("a = f'{b} {c}'  # d\n", "a = f'{b} {c}'"),
        ],
    )
    def test_only_code_is_left(self, code, left):
        found = without_strings(code)

        assert found.count('\n') == code.count('\n')
        assert found.replace(' ', '').strip() == left.replace(' ', '').strip()

    @pytest.mark.parametrize('code', ['a = (', "a = 'open\n", 'if a:\n  b\n c\n', '\x00'])
    def test_what_is_no_python_stays_as_it_is(self, code):
        assert without_strings(code) == code
        assert not Code({'n.py': code}).calls

    def test_texts_and_calls_are_found_in_python_files_only(self):
        files = {'n.py': "math.isnan(a) or 'Farenheit'", 'package.xml': "<a b='c'>isfinite(1)</a>"}

        assert Code(files).texts == {'Farenheit'}
        assert set(Code(files).calls) == {'isnan'}

    def test_name_in_a_class_has_no_value_of_the_file(self):
        file = 'rate = 0.5\ncreate_timer(options.rate, f)\n'
        of_class = 'class N:\n    rate = 0.5\n    def go(self): create_timer(self.rate, f)\n'

        assert Code({'n.py': file}).numbers('create_timer') == []
        assert Code({'n.py': of_class}).numbers('create_timer') == [0.5]

    def test_an_escape_that_python_warns_of_is_the_learners(self):
        assert Code({'n.py': "a = '\\d'"}).texts == {'\\d'}


@pytest.mark.parametrize(
    ('code', 'found'),
    [
        ('message.timestamp = now', True),
        ('message.timestamp.sec = 3', True),
        ('Temperature(timestamp=now)', True),
        ("setattr(message, 'timestamp', now)", True),
        ('timestamp = now', False),
        ('# message.timestamp = now', False),
    ],
)
def test_variable_with_the_name_of_a_field_is_not_the_field(code, found):
    assert Code({'n.py': code}).has_field('timestamp') is found


class TestPauses:
    """A sleep counts only in a function that ROS calls."""

    @pytest.mark.parametrize(
        'made',
        [
            'self.create_timer(1.0, self.tick)',
            'self.create_timer(1.0, callback=self.tick)',
            "self.create_subscription(String, 'chatter', self.tick, 10)",
            "self.create_service(Trigger, 'now', self.tick)",
            'self.create_timer(1.0, partial(self.tick, 3))',
            'self.create_timer(1.0, tick)',
        ],
    )
    @pytest.mark.parametrize('code', ['time.sleep(1.0)', 'sleep(PAUSE_S)', 'self.rate.sleep()'])
    def test_a_callback_that_sleeps_is_found_with_its_line(self, made, code):
        assert pause_in_callback({'n.py': body(code, made)}) == ('tick', 5)

    @pytest.mark.parametrize(
        ('code', 'found'),
        [
            (body('self.work()\n    def work(self):\n        time.sleep(1.0)'), ('tick', 7)),
            (body('time.sleep(1.0)') + OTHER, ('tick', 5)),
            (OTHER + body('time.sleep(1.0)'), ('tick', 8)),
            (LAMBDA, ('', 1)),
            # Only a loop or an await inside the callback is a cause of its own.
            (f'while True:\n    {LAMBDA}\n', ('', 2)),
            (f'async def main():\n    await f({LAMBDA})\n', ('', 2)),
            (body('pass  # time.sleep(1)'), None),
            (body('time.sleep(0.01)'), None),
            (body('await asyncio.sleep(1.0)').replace('def t', 'async def t'), None),
            (body('while True:\n            time.sleep(1.0)'), None),
            ('def work():\n    time.sleep(1.0)\nThread(target=work).start()\n', None),
            ('def tick(:\n    time.sleep(1.0)\n', None),
        ],
    )
    def test_pause_counts_if_a_callback_waits_for_it(self, code, found):
        assert pause_in_callback({'n.py': code}) == found

    def test_each_function_is_looked_at_once(self, monkeypatch):
        """Otherwise a file with thousands of callbacks would take a long time."""
        chain = '\n'.join(f'def f{n}():\n    f{n + 1}()' for n in range(200))
        given = '\n'.join(f'node.create_timer(1.0, f{n})' for n in range(200))
        looked = []
        monkeypatch.setattr(mistakes, '_pauses', lambda _, body: looked.append(body))

        assert pause_in_callback({'n.py': f'{chain}\n{given}\n'}) is None
        assert len(looked) == 200


LOGGING = (
    'import logging\n'
    "log = logging.getLogger('n')\n"
    'class N(Node):\n'
    '    def __init__(self):\n'
    "        self.get_logger().info('ready', once=True)\n"
    '        random.seed(1)\n'
    '        self.create_timer(1.0, self.tick)\n'
    '    def tick(self):\n'
    '        {}\n'
)


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
    assert leaves_out({'n.py': LOGGING.format(line)}, 'info') == found


@pytest.mark.parametrize(
    ('line', 'names', 'found'),
    [
        ("log.warning('a')", 'warning', True),
        ("logging.warning('a')", 'warning', True),
        ("logging.getLogger().warning('a')", 'warning', True),
        ("log.warning('a'); self.get_logger().warning('a')", 'warning', False),
        ("self.log = log; self.log.warning('a')", 'warning', True),
        ("self.logger.warning('a')", 'warning', False),
        (
            "self.h['a'] = logging.getLogger('x'); self.get_logger().warning('a')",
            'warning',
            False,
        ),
        ("log.info('a')", 'info', False),
    ],
)
def test_loggers_of_python_are_distinguished_from_those_of_nodes(line, names, found):
    assert logs_with_python({'n.py': LOGGING.format(line)}, names) is found


def test_logger_of_python_belongs_to_its_file():
    files = {
        'a.py': "import logging\nlog = logging.getLogger('a')\n",
        'b.py': "log = node.get_logger()\nlog.warning('b')\n",
    }

    assert not logs_with_python(files, 'warning')
