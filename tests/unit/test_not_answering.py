"""A running program that does not answer: its thread has ended, or a callback sleeps."""

from handmade_runs import at, graph, run_of
import pytest

from autograder.judging.causes.ended import why_no_node, why_silent

SPUN = (
    '  File "/usr/lib/python3.12/threading.py", line 1010, in run\n'
    '  File "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/__init__.py", line 226, in spin\n'
)
ERROR = 'TypeError: can only concatenate str (not "int") to str'
SLEEPS = (
    'class Talker(Node):\n'
    '    def __init__(self):\n'
    '        self.create_timer(1.0, self.speak)\n'
    '    def speak(self):\n'
    '        time.sleep(1.5)\n'
)
LOOPS = SLEEPS.replace('        time', '        while rclpy.ok():\n            time')


def died(frames=SPUN, file='/submission/talker.py', error=ERROR):
    """Return the output of Python when an exception ends a thread."""
    return (
        'Exception in thread Thread-1 (spin):\nTraceback (most recent call last):\n'
        f'{frames}  File "{file}", line 4, in speak\n    x\n{error}\n'
    )


def run(*events, answered=False, code=SLEEPS, **facts):
    """Return a run whose node answers at the end or not; with None, it has no node."""
    nodes = ['/talker'] if answered is not None else []
    asked = [at(19.0, 'asked', node=node, answered=answered) for node in nodes]
    return run_of(*events, *asked, graph(nodes=nodes), code=code, file='talker.py', **facts)


class TestThreads:
    @pytest.mark.parametrize('reason', ['complete', 'cpu_limit'])
    def test_exception_in_the_thread_that_spins_is_reported_with_its_line(self, reason):
        found = why_silent(run(reason=reason, stderr=died(), code=LOOPS))

        assert found.cause_id == 'exception'
        assert found.line == 4
        assert found.text.endswith('to str. The exception ended the thread that spins the node.')

    def test_known_exception_keeps_its_own_words(self):
        error = "AttributeError: 'String' object has no attribute 'dat'"

        found = why_silent(run(stderr=died(error=error)))

        assert found.cause_id == 'no_field'
        assert 'The type String has no field dat' in found.text

    def test_another_thread_explains_a_node_that_nobody_ever_spins(self):
        """The thread may have spun the node; if the node answers, the thread was only a helper."""
        helper = {'stderr': died(frames=''), 'code': ''}

        never = why_silent(run(**helper))

        assert never.text.endswith('The exception ended a thread of your program.')
        assert why_silent(run(**helper, answered=True)) is None

    def test_thread_that_ends_before_it_has_a_node_is_reported(self):
        found = why_no_node(run(stderr=died(frames=''), answered=None), '/talker')

        assert found.cause_id == 'exception'
        assert 'The exception ended a thread' in found.text

    def test_exception_below_code_that_is_not_the_learners_is_not_theirs(self):
        found = why_silent(run(stderr=died(file='/opt/ros/x.py'), code='rclpy.spin(node)'))

        assert found.cause_id == 'blocked'

    def test_words_of_an_exception_do_not_show_what_was_sent(self):
        """The message of an exception could reveal hidden inputs."""
        sent = at(1.0, 'input', index=0, data={'data': 47.25})
        error = 'ValueError: 47.25 is too much'

        found = why_silent(run(sent, stderr=died(error=error), facts={'secret': True}))

        assert found.cause_id == 'exception'
        assert '47' not in found.text


SERVES = (
    'while rclpy.ok():\n    publisher.publish(message)\n    rclpy.spin_once(node)\n'
    '    time.sleep(0.5)\n'
)


class TestCode:
    """The code shows why a node does not answer."""

    def test_long_pause_explains_a_node_that_does_not_answer(self):
        found = why_silent(run())

        assert found.cause_id == 'sleeps_in_callback'
        assert found.text.startswith('speak() sleeps.')
        assert found.line == 5

    @pytest.mark.parametrize(
        ('code', 'cause_id'),
        [
            (f'{LOOPS}rclpy.spin(node)\n', 'blocked'),
            (SERVES, 'own_loop'),
            (f'node.create_timer(1.0, f)\n{SERVES}', 'blocked'),
            (f'def on_configure(self, state):\n    pass\n{SERVES}', 'blocked'),
        ],
        ids=['in an endless loop', 'serves its node', 'a timer', 'a transition'],
    )
    def test_pause_in_a_loop_is_not_one_in_a_callback(self, code, cause_id):
        assert why_silent(run(code=code)).cause_id == cause_id

    def test_executor_without_a_node_is_reported(self):
        found = why_silent(run(code='executor = SingleThreadedExecutor()\nexecutor.spin()\n'))

        assert 'has no node' in found.text

    def test_node_that_answers_is_not_told_to_sleep_less(self):
        assert why_silent(run(answered=True)) is None
