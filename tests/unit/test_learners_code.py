"""What a learner's code contains: comments and strings do not count, nor does invalid Python."""

import pytest

from autograder.submission.code import code_places
from autograder.submission.code.code_places import (
    FieldUse,
    Pause,
    pause_in_callback,
    use_of_field,
)
from autograder.submission.code.learners_code import Code, without_texts

BROKEN = 'def tick(:\n    time.sleep(1.0)\n'


def node(callback: str, made: str = 'self.create_timer(1.0, self.tick)') -> dict[str, str]:
    """Return the file of a node with one callback, whose body is in line 5."""
    code = f'class N(Node):\n    def __init__(self):\n        {made}\n    def tick(self):\n'
    return {'n.py': f'{code}        {callback}\n'}


class TestTexts:
    """Comments and strings become blanks, and the rest keeps its place."""

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
        """The code in the braces of an f-string stays."""
        found = without_texts(code)

        assert found.count('\n') == code.count('\n')
        assert found.replace(' ', '').strip() == left.replace(' ', '').strip()

    @pytest.mark.parametrize('code', ['a = (', "a = 'open\n", 'if a:\n  b\n c\n', '\x00'])
    def test_what_is_no_python_stays_as_it_is(self, code):
        assert without_texts(code) == code
        assert not Code({'n.py': code}).calls

    def test_texts_and_calls_are_found_in_python_files_only(self):
        files = {'n.py': "math.isnan(a) or 'Farenheit'", 'package.xml': "<a b='c'>isfinite(1)</a>"}

        assert Code(files).texts == {'Farenheit'}
        assert set(Code(files).calls) == {'isnan'}

    def test_an_escape_that_python_warns_of_is_the_learners(self):
        """The grader prints no warnings of it."""
        assert Code({'n.py': "a = '\\d'"}).texts == {'\\d'}


@pytest.mark.parametrize(
    ('code', 'use'),
    [
        ('message.timestamp = now', FieldUse(True, False, False)),
        ('message.timestamp.sec = 3', FieldUse(True, False, False)),
        ('Temperature(timestamp=now)', FieldUse(True, False, False)),
        ("setattr(message, 'timestamp', now)", FieldUse(True, False, False)),
        ('message.timestamp = Time()', FieldUse(True, True, False)),
        ('message.timestamp = rclpy.time.Time().to_msg()', FieldUse(True, True, False)),
        ('message.timestamp = Time(sec=3)', FieldUse(True, False, False)),
        ('timestamp = now', FieldUse(False, False, True)),
        ('# message.timestamp = now', FieldUse(False, False, False)),
    ],
)
def test_what_is_done_with_a_field(code, use):
    """A variable with the name of the field does not count."""
    assert use_of_field({'n.py': code}, 'timestamp') == use


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
        """The callback is found, whatever it is passed to and whichever call sleeps."""
        assert pause_in_callback(node(code, made)) == Pause('tick', 5)

    def test_what_a_callback_calls_belongs_to_it(self):
        files = node('self.work()\n    def work(self):\n        time.sleep(1.0)')

        assert pause_in_callback(files) == Pause('tick', 7)

    def test_callbacks_of_one_name_in_two_classes_are_all_looked_at(self):
        """Two classes may have a callback with one name, and both are read."""
        other = 'class M(Node):\n    def tick(self):\n        pass\n'
        code = node('time.sleep(1.0)')['n.py']

        assert pause_in_callback({'n.py': code + other}) == Pause('tick', 5)
        assert pause_in_callback({'n.py': other + code}) == Pause('tick', 8)

    def test_a_lambda_has_no_name(self):
        files = {'n.py': 'node.create_timer(1.0, lambda: time.sleep(1.0))'}

        assert pause_in_callback(files) == Pause('', 1)

    @pytest.mark.parametrize(
        'code',
        [
            'pass  # time.sleep(1)',
            'time.sleep(0.01)',
            'await asyncio.sleep(1.0)',
            'while True:\n            time.sleep(1.0)',
        ],
    )
    def test_what_nobody_waits_for_is_none(self, code):
        """A comment, a short sleep, an await and a loop are not pauses."""
        files = {name: text.replace('def t', 'async def t') for name, text in node(code).items()}

        assert pause_in_callback(files) is None

    def test_a_function_that_ros_does_not_call_may_sleep(self):
        files = {'n.py': 'def work():\n    time.sleep(1.0)\nThread(target=work).start()\n'}

        assert pause_in_callback(files) is None
        assert pause_in_callback({'n.py': BROKEN}) is None

    def test_each_function_is_looked_at_once(self, monkeypatch):
        """A file with thousands of callbacks takes no time."""
        chain = '\n'.join(f'def f{n}():\n    f{n + 1}()' for n in range(200))
        given = '\n'.join(f'node.create_timer(1.0, f{n})' for n in range(200))
        looked = []
        monkeypatch.setattr(code_places, '_pause', looked.append)

        assert pause_in_callback({'n.py': f'{chain}\n{given}\n'}) is None
        assert len(looked) == 200
