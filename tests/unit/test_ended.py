"""Causes come from the recording, and are never named without evidence."""

from dataclasses import replace

import pytest

from autograder.exam.exam import Run
from autograder.exam.scenario import Names
from autograder.exam.specification import each, Specification
from autograder.judging.causes import ended as causes
from autograder.recording import Recording
from autograder.runs.observe import LARGEST_RECORDING
from autograder.runs.program import PACKAGE_LIMITS
from autograder.runs.watchdog import BUSY_S
from autograder.sandboxes.confinement import Limits

ANSWERED = {'event': 'asked', 'node': '/n', 'answered': True}
TOPIC, TYPE = '/temperature_topic', 'temp_monitor_pkg/msg/Temperature'


def run(*events, nodes=('/n',), endpoints=(), files=None, **process):
    graph = {'event': 'graph', 'when': 'end', 'nodes': list(nodes), 'endpoints': list(endpoints)}
    last = {'event': 'process', 'exit': None, 'killed': '', 'stdout': '', 'stderr': '', **process}
    return Run(files or {'temp_publisher.py': ''}, Recording({}, (*events, graph, last)))


def end(topic=TOPIC, kind='publisher', type_name=TYPE):
    return {'topic': topic, 'kind': kind, 'node': '/n', 'type': type_name, 'qos': {}}


def traceback(line, error):
    """Return a traceback with a frame in the runner and one in the student's code."""
    return (
        'Traceback (most recent call last):\n'
        '  File "/grader/inside/run_node.py", line 40, in main\n    runpy\n'
        f'  File "/submission/temp_publisher.py", line {line}, in tick\n    x\n{error}\n'
    )


@pytest.mark.parametrize(
    ('seen', 'cause_id', 'words'),
    [
        (run(endpoints=[end('/temprature_topic')]), 'topic_name', 'did you mean /temperature_t'),
        (run(endpoints=[end(type_name='std_msgs/msg/String')]), 'wrong_type', 'std_msgs/msg/Str'),
        (run(endpoints=[end(kind='subscription')]), 'wrong_direction', 'not a publisher'),
        (run(), 'no_endpoint', 'creates no publisher'),
        # Every lifecycle node has these topics.
        (
            run(endpoints=[end('/n/transition_event'), end('/rosout')]),
            'no_endpoint',
            'creates no publisher',
        ),
        (run(nodes=(), exit=0), 'exited_early', 'ended by itself'),
        (run(nodes=(), exit=139), 'died', 'exit code 139'),
        (run(nodes=(), killed='memory_limit'), 'memory_limit', '1 GiB'),
    ],
    ids=lambda value: value if isinstance(value, str) and '_' in value else '',
)
def test_missing_publisher_is_explained_from_the_graph(seen, cause_id, words):
    found = causes.why_no_endpoint(seen, 'publisher', TOPIC, TYPE)

    assert found.cause_id == cause_id
    assert words in found.text
    assert found.try_this


@pytest.mark.parametrize(
    ('topic', 'cause_id', 'words'),
    [
        # A topic outside the namespace has the correct name with an extra leading slash.
        ('/reading', 'absolute_name', 'outside the namespace /lab'),
        ('/lab/readings', 'topic_name', 'did you mean'),
    ],
)
def test_topic_in_a_namespace_is_answered_with_the_relative_name(topic, cause_id, words):
    """The code needs only the last part, because the command line sets the namespace."""
    seen = run(endpoints=[end(topic)], nodes=('/lab/n',))

    found = causes.why_no_endpoint(seen, 'publisher', '/lab/reading', TYPE)

    assert found.cause_id == cause_id
    assert words in found.text
    assert "'reading'" in found.try_this


def test_another_topic_of_the_exam_is_no_slip():
    names = Names(published={'/speed': TYPE, '/turn': TYPE})
    seen = replace(run(endpoints=[end('/speed')]), facts={'exam_names': names})

    assert causes.why_no_endpoint(seen, 'publisher', '/turn', TYPE).cause_id == 'no_endpoint'


@pytest.mark.parametrize(
    ('error', 'cause_id', 'line'),
    [
        ('NotImplementedError: write the callback', 'not_started', 7),
        ('ZeroDivisionError: float division by zero', 'exception', 7),
        # rclpy reports what a transition callback returns, which has no line.
        ("AttributeError: 'NoneType' object has no attribute 'to_label'", 'no_return', None),
        ("AttributeError: 'bool' object has no attribute 'to_label'", 'wrong_return', None),
    ],
)
def test_exception_is_named_with_its_line(error, cause_id, line):
    """The line number is counted in the learner's file."""
    found = causes.why_it_ended(run(exit=1, stderr=traceback(7, error)))

    assert (found.cause_id, found.line) == (cause_id, line)


@pytest.mark.parametrize(
    ('place', 'short', 'explains'),
    [(0, True, False), (1, True, True), (1, False, False), (2, True, True)],
)
def test_end_explains_only_what_is_missing_at_the_end(place, short, explains):
    """A later input shows that the program was still running; a wrong answer precedes the end."""
    sent = [{'event': 'input', 'index': number} for number in range(2)]
    seen = run(*sent, exit=1, stderr=traceback(7, 'ZeroDivisionError: division by zero'))
    asked = Specification((1, 2, 3), each(lambda one: 1))

    found = causes.why_silent(causes.while_running(seen, asked, place, short))

    assert (found is not None and found.cause_id == 'exception') is explains


@pytest.mark.parametrize(
    ('answers', 'cause_id', 'words'),
    [
        ({'/n': False}, 'never_spun', ''),
        ({'/n': True}, None, ''),
        ({'/n': False, '/helper': True}, 'other_node_spun', 'spins the node helper but not n'),
        ({'/n': True, '/helper': False}, None, ''),
    ],
    ids=['never spun', 'alive', 'only the helper is spun', 'helper that nobody spins'],
)
def test_silence_is_explained_by_the_nodes_that_answer(answers, cause_id, words):
    asked = [{'event': 'asked', 'node': one, 'answered': said} for one, said in answers.items()]

    found = causes.why_silent(run(*asked, nodes=sorted(answers), endpoints=[end()]))

    assert (found and found.cause_id) == cause_id
    assert found is None or words in found.text


def test_parameter_of_another_type_is_reported_without_its_value():
    """The value in rclpy's message is not shown, because the grader has set it."""
    error = (
        "rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'limit' to "
        "'-1.87' of type 'DOUBLE', expecting type 'INTEGER': limit"
    )

    found = causes.why_silent(run(exit=1, stderr=traceback(7, error)))

    assert found.cause_id == 'parameter_type'
    assert '1.87' not in found.text


SPIN = 'def main():\n    rclpy.spin(node)\n\n\n'
ONCE = 'def main():\n    rclpy.spin_once(node)\n\n\n'
CALL = "if __name__ == '__main__':\n    main()\n"


@pytest.mark.parametrize(
    ('code', 'cause_id'),
    [
        (f"{SPIN}if __name__ == '__main__':\n    pass\n", 'main_not_called'),
        (f"{SPIN}if __name__ == '__main__':\n    main\n", 'main_not_called'),
        (f"{SPIN}if __name__ == 'main':\n    main()\n", 'main_not_called'),
        ('def main():\n    node = Talker()\n\n\nmain()\n', 'no_spin'),
        ('def main():\n    # The pattern with rclpy.spin.\n    Talker()\n\n\nmain()\n', 'no_spin'),
        (f'{ONCE}main()\n', 'spins_once'),
        (f"{ONCE}if __name__ == 'x':\n    pass\n{CALL}", 'spins_once'),
        (f'{SPIN}main()\n', 'exited_early'),
        (f'async {SPIN}asyncio.run(main())\n', 'exited_early'),
        (f'{SPIN}run = main\nrun()\n', 'exited_early'),
    ],
)
def test_program_that_is_over_at_once_is_explained_by_what_it_says(code, cause_id):
    ended = run(nodes=(), exit=0, files={'talker.py': code})

    assert causes.why_it_ended(ended).cause_id == cause_id


@pytest.mark.parametrize(
    ('code', 'cause_id', 'words'),
    [
        ('rclpy.spin(node)', 'exited_early', 'was running'),
        ('while rclpy.ok():\n    rclpy.spin_once(node)', 'exited_early', 'was running'),
        ('rclpy.spin_until_future_complete(node, done)', 'spins_until', 'was running'),
        ('try:\n    rclpy.spin(n)\nexcept Exception as e:\n    print(e)', 'swallowed', 'catches'),
        (
            'try:\n    rclpy.spin(n)\nexcept ExternalShutdownException:\n    ...',
            'exited_early',
            '',
        ),
        (
            'try:\n    float(t)\nexcept Exception as e:\n    raise SystemExit\nrclpy.spin(n)',
            'exited_early',
            '',
        ),
        # A single spin_once() may have run only the callback of a service call.
        ('rclpy.spin_once(node)  # for a while', 'spins_once', 'runs one callback'),
        ('for node in nodes:\n    rclpy.spin_once(node)', 'spins_a_while', 'limited number'),
    ],
)
def test_program_that_ends_in_a_callback_is_not_told_to_spin(code, cause_id, words):
    """If a program ends in a callback, its node was spun, so no spin is missing."""
    start = {'event': 'graph', 'when': 'start', 'nodes': ['/n'], 'endpoints': []}

    found = causes.why_it_ended(run(start, exit=0, files={'n.py': code}))

    assert found.cause_id == cause_id
    assert words in found.text


def test_entry_point_calls_main():
    ended = run(nodes=(), exit=0, files={'n.py': SPIN, 'setup.py': "['talker = a.n:main']"})

    assert causes.why_it_ended(ended).cause_id == 'exited_early'


@pytest.mark.parametrize(
    ('code', 'cause_id'),
    [
        ("node = Node('n')\nnode.destroy_node()\nrclpy.spin(node)\n", 'destroyed_early'),
        ("rclpy.init(domain_id=7)\nNode('n')\n", 'other_domain'),
        ("os.environ['ROS_DOMAIN_ID'] = '7'\nNode('n')\n", 'other_domain'),
    ],
)
def test_missing_node_is_explained_by_the_code(code, cause_id):
    assert causes.why_no_node(run(nodes=(), files={'n.py': code}), '/n').cause_id == cause_id


def test_node_that_could_not_be_seen_is_not_called_missing():
    """If the node may have been missed, the cause says what was seen and how to investigate."""
    code = "class Talker(Node):\n    def __init__(self):\n        super().__init__('talker')\n"

    found = causes.why_no_node(run(nodes=(), files={'talker.py': code}), '/talker')

    assert 'does not appear' in found.text
    assert 'nodes()' in found.try_this


@pytest.mark.parametrize('period', ['500', '1000.0', 'PERIOD_MS'])
def test_period_in_milliseconds_is_reported(period):
    """A period in milliseconds is reported, because the first call is minutes away."""
    code = f'PERIOD_MS = 500\nself.create_timer({period}, self.speak)\n'

    found = causes.why_silent(run(ANSWERED, endpoints=[end()], files={'talker.py': code}))

    assert found.cause_id == 'period_unit'
    assert 'seconds' in found.text


@pytest.mark.parametrize(
    ('code', 'cause_id'),
    [
        ('self.create_timer(1.0, self.speak)', 'never_publishes'),
        ('def speak(self):\n    self.publisher.publish(String())', 'no_timer'),
        ('self.create_timer(1.0, self.speak)\nself.publisher.publish(String())', 'silent'),
        ('', 'silent'),
        (
            'if pub.get_subscription_count() > 0:\n    pub.publish(m)\ncreate_timer(1.0, f)',
            'only_if_heard',
        ),
    ],
)
def test_silence_is_explained_by_what_the_code_lacks(code, cause_id):
    seen = run(ANSWERED, endpoints=[end()], files={'talker.py': code})

    assert causes.why_no_message(seen).cause_id == cause_id


def test_without_a_cause_it_is_said_how_to_look():
    """The message shortens a topic to its last part, so that the namespace stays hidden."""
    assert "echo('chatter')" in causes.how_to_investigate(run(endpoints=[end('/xkcdq/chatter')]))
    assert 'xkcdq' not in causes.how_to_investigate(run(endpoints=[end('/xkcdq/chatter')]))
    assert 'logs()' in causes.how_to_investigate(run())
    assert causes.how_to_investigate(run(nodes=())) == ''


@pytest.mark.parametrize('limit', sorted(causes.LIMITS))
def test_each_limit_says_what_was_too_much_and_where_to_look(limit):
    found = causes.why_it_ended(run(killed=limit))

    assert found.cause_id == limit
    assert found.text.startswith('The grader stopped your program: ')
    assert found.try_this.startswith('Look for ')


@pytest.mark.parametrize(('package', 'limits'), [('', Limits()), ('thermo', PACKAGE_LIMITS)])
def test_shown_limits_are_the_enforced_ones(package, limits):
    ended = {
        kind: causes.why_it_ended(Run({}, run(killed=kind).recording, {'package': package})).text
        for kind in causes.LIMITS
    }

    assert f' {limits.cpu_s} s' in ended['cpu_limit']
    assert f' {limits.memory >> 30} GiB' in ended['memory_limit']
    assert f' {limits.output >> 20} MB' in ended['output_limit']
    assert f' {limits.folder >> 20} MB' in ended['disk_limit']
    assert f' {limits.inodes} files' in ended['inode_limit']
    assert f' {BUSY_S:g} s' in ended['busy_before_node']
    assert f' {LARGEST_RECORDING >> 20} MB' in ended['too_much_recorded']
    assert 'packets' in ended['probe_broken']
