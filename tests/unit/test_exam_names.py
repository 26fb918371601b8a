"""Advice with code uses the names of the judged exam, never those of a different exam."""

import ast
from pathlib import Path
import re

import pytest

from autograder import judging
from autograder.errors import ExamInvalid, GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam, Failed, Run
from autograder.exam.scenario import Names, Scenario
from autograder.exam.steps import Call, Feed, Join, Offer, set_parameters
from autograder.judging.checks import require_messages
from autograder.judging.judge import judge
from autograder.recording import Recording

CODE = 'import rclpy\n\n\nclass Rover(Node):\n    {}\n'
SHARED = (
    'causes/builds.py',
    'causes/by_code.txt',
    'causes/by_evidence.txt',
    'causes/by_exception.txt',
    'causes/ended.py',
    'causes/exceptions.py',
    'causes/of_builds.txt',
    'causes/of_calls.txt',
    'causes/of_values.txt',
    'checks.py',
)
"""Modules and tables with advice for any exam; all others explain one exercise."""


def rover() -> Exam:
    """Return an exam with names that no lesson uses."""
    exam = Exam(
        'rover',
        title='The rover',
        assignment='01_x',
        part=1,
        cells=('rover',),
        requires=('rover.py',),
        scenario=Scenario(
            file='rover.py',
            arguments=('-p', 'max_speed:=0.5'),
            watch={'/qqqqqq/cmd_vel': 'geometry_msgs/msg/Twist'},
            feed={'/scan': 'sensor_msgs/msg/LaserScan'},
            steps=(set_parameters('/rover', {'max_turn': 1.0}),),
        ),
    )

    @exam.check(points=1)
    def drives(run: Run) -> None:
        """It drives."""
        require_messages(run, topic='/qqqqqq/cmd_vel')

    return exam


def recording(error: str = '', *endpoints: tuple[str, str]) -> Recording:
    """Return the recording of a run with an exception in line 5, or with these publishers."""
    where = 'Traceback (most recent call last):\n  File "/submission/rover.py", line 5, in x\n'
    ends = [
        {'kind': 'publisher', 'node': '/qqqqqq/rover', 'topic': topic, 'type': kind}
        for topic, kind in endpoints
    ]
    ended = {'exit': 1 if error else None, 'stderr': f'{where}    x\n{error}\n' if error else ''}
    return Recording(
        {},
        (
            {'event': 'graph', 'nodes': ['/qqqqqq/rover'], 'endpoints': ends},
            {'event': 'end', 'reason': 'complete'},
            {'event': 'process', 'killed': '', 'stdout': '', **ended},
        ),
    )


def feedback(line: str, error: str) -> str:
    """Return the feedback on a program that ended with an exception in a line."""
    exam = rover()
    (check,) = judge(exam, Run({'rover.py': CODE.format(line)}, recording(error), exam.facts))
    return f'{check.cause} {check.try_this}'


@pytest.mark.parametrize(
    ('line', 'error', 'words'),
    [
        (
            "self.create_publisher('cmd_vel', 10)",
            "TypeError: Node.create_publisher() missing 1 required positional argument: 'topic'",
            "create_publisher(Twist, 'cmd_vel', 10)",
        ),
        (
            'self.create_subscription()',
            'TypeError: rclpy_resolve_name(): incompatible function arguments',
            "create_publisher(Twist, 'cmd_vel', 10)",
        ),
        (
            'self.create_subscription(1)',
            'TypeError: Expected QoSProfile or int, but received',
            "create_subscription(LaserScan, 'scan', self.callback, 10)",
        ),
        (
            "self.get_parameter('max_sped')",
            'rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared '
            'parameter(s): max_sped',
            "declare_parameter('max_sped', ...)",
        ),
        (
            'self.declare_parameter()',
            "TypeError: Node.declare_parameter() missing 1 required positional argument: 'name'",
            "declare_parameter('max_speed', ...)",
        ),
        (
            'Twist()',
            "NameError: name 'Twist' is not defined",
            'from geometry_msgs.msg import Twist',
        ),
        (
            'from std_msgs.msg import Twist',
            "ImportError: cannot import name 'Twist' from 'std_msgs.msg'",
            'from geometry_msgs.msg import Twist',
        ),
        (
            'from sensor_msg.msg import LaserScan',
            "ModuleNotFoundError: No module named 'sensor_msg.msg'",
            'Did you mean sensor_msgs.msg?',
        ),
        (
            'self.out.publish(Twist)',
            "AttributeError: 'property' object has no attribute 'x'",
            'message = Twist()',
        ),
    ],
)
def test_advice_has_the_names_of_the_exam(line, error, words):
    said = feedback(line, error)

    assert words in said
    assert 'qqqqqq' not in said
    assert '$' not in said


def test_parameter_of_the_learner_is_quoted_where_ros_names_it():
    """Only the exception shows which of several parameters is meant."""
    asked = 'rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared '

    assert 'the parameter max_turn, which' in feedback('x', f'{asked}parameter(s): max_turn')
    assert "declare_parameter('max_speed'" in feedback('x', f'{asked}parameter(s): []')


def test_names_come_from_all_steps():
    names = Names.of(
        Scenario(
            steps=(
                Join('late', '/map', 'nav_msgs/msg/Path'),
                Offer('sensor', '/scan', 'sensor_msgs/msg/LaserScan'),
                Feed('sensor', []),
                Call('/n', 'get_parameters', 'x', {'names': ['gain']}),
            )
        )
    )

    assert names.fill('$type $topic $heard_type $heard_topic $parameter') == (
        'Path map LaserScan scan gain'
    )
    assert Names().fill("$type, '$topic' $parameter $other") == "Type, 'topic' name $other"


@pytest.mark.parametrize('name', SHARED)
def test_shared_advice_names_no_exercise(name):
    every = [catalog.load(one, hidden=False).facts['exam_names'] for one in catalog.names(False)]
    topics = {topic.rpartition('/')[2] for one in every for topic in (*one.published, *one.heard)}
    parameters = {one for names in every for one in names.parameters}
    types = {kind for one in every for names in one.homes.values() for kind in names.split()}
    quoted = '|'.join(sorted(topics | parameters))
    foreign = re.compile(rf"'(?:{quoted})'|\b(?:{'|'.join(sorted(types))})[(,]")

    text = (Path(judging.__file__).parent / name).read_text(encoding='utf-8')
    texts = text.splitlines()
    if name.endswith('.py'):
        texts = [one.value for one in ast.walk(ast.parse(text)) if isinstance(one, ast.Constant)]
    code = [text for text in texts if isinstance(text, str) and '(' in text]

    assert types
    assert topics
    assert parameters
    assert not [text for text in code if foreign.search(text)]


# -- messages on a topic ---------------------------------------------------------------------


def twist(topic, kind='geometry_msgs/msg/Twist'):
    """Return the result of the check on a program that publishes on this topic."""
    exam = rover()
    (check,) = judge(exam, Run({'rover.py': CODE}, recording('', (topic, kind)), exam.facts))
    return check


def test_bare_require_messages_asks_did_you_mean():
    check = twist('/qqqqqq/cmd_val')

    assert check.cause_id == 'topic_name'
    assert 'did you mean' in check.cause
    assert "'cmd_vel'" in check.try_this


def test_bare_require_messages_names_another_type():
    check = twist('/qqqqqq/cmd_vel', 'std_msgs/msg/String')

    assert check.cause_id == 'wrong_type'
    assert 'Pass the class Twist' in check.try_this


MESSAGE = {'event': 'message', 'topic': '/qqqqqq/cmd_vel', 'listener': None, 'data': {}}


def test_bare_require_messages_takes_what_came_on_the_topic():
    exam = rover()
    seen, *_ = recording('', ('/qqqqqq/cmd_vel', 'geometry_msgs/msg/Twist')).events
    run = Run({}, Recording({}, (seen, MESSAGE, MESSAGE)), exam.facts)

    assert len(require_messages(run, topic='/qqqqqq/cmd_vel', least=2)) == 2
    (check,) = judge(exam, run)
    assert check.points == 1


def test_message_of_a_publisher_that_was_never_seen_is_no_evidence():
    """If a program ends at once, chance decides whether the probe receives its messages."""
    run = Run({}, Recording({}, (MESSAGE, MESSAGE)), rover().facts)

    with pytest.raises(Failed):
        require_messages(run, topic='/qqqqqq/cmd_vel')


@pytest.mark.parametrize('topic', ['', '/cmd_val'])
def test_topic_that_the_scenario_does_not_watch_is_a_mistake_of_the_exam(topic):
    exam = rover()
    with pytest.raises(ExamInvalid, match=r"watches \('/qqqqqq/cmd_vel'\), got"):
        require_messages(Run({}, recording(), exam.facts), topic=topic)

    exam.check(points=1)(_asks_for_another_topic)
    with pytest.raises(GraderError, match='got'):
        judge(exam, Run({}, recording(), exam.facts))


def _asks_for_another_topic(run: Run) -> None:
    """It asks."""
    require_messages(run, topic='/nothing')
