"""Grade a node that uses messages and services of other packages."""

from dataclasses import replace

import pytest

from autograder.authoring.exam_mistakes import unsendable
from autograder.errors import ProbeFailed
from autograder.exam.exam import Exam, Failed, Run
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, Call, Feed
from autograder.grading.examine import Engine
from autograder.judging.checks import require_answers, require_endpoint
from autograder.results import Verdict
from autograder.runs.observe import observe
from autograder.sandboxes.choose import strongest

pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]

TWIST, SCAN = 'geometry_msgs/msg/Twist', 'sensor_msgs/msg/LaserScan'
ODOMETRY, SET_BOOL = 'nav_msgs/msg/Odometry', 'std_srvs/srv/SetBool'
PILOT = """
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.running = False
        self.cmd_vel = self.create_publisher(Twist, 'cmd_vel', 10)
        self.odometry = self.create_publisher(Odometry, 'odom', 10)
        self.create_service(SetBool, 'run', self.on_run)
        self.create_subscription(LaserScan, 'scan', self.on_scan, 10)

    def on_run(self, request, response):
        response.success = request.data != self.running
        response.message = 'started' if request.data else 'stopped'
        self.running = request.data
        return response

    def on_scan(self, scan):
        message = Twist()
        message.linear.x = 0.5 if self.running and min(scan.ranges) > 1.0 else 0.0
        self.cmd_vel.publish(message)
        odometry = Odometry(child_frame_id='base')
        odometry.twist.twist = message
        self.odometry.publish(odometry)


def main():
    rclpy.init()
    rclpy.spin(Pilot())


main()
"""


@pytest.fixture(scope='module')
def exam() -> Exam:
    """Return the exam of a robot that drives while it is allowed and no obstacle is near."""
    made = Exam(
        'pilot',
        title='Pilot',
        assignment='20_pilot',
        part=1,
        cells=('pilot',),
        requires=('pilot.py',),
        read='Part 1: Drive',
        scenario=Scenario(
            file='pilot.py',
            watch={'/cmd_vel': TWIST, '/odom': ODOMETRY},
            feed={'/scan': SCAN},
            steps=(
                Feed('/scan', [{'ranges': [2.0, 3.0]}]),
                Call('/pilot', '/run', SET_BOOL, {'data': True}),
                Feed('/scan', [{'ranges': [2.0, 3.0]}, {'ranges': [0.5, 3.0]}]),
                Advance(1),
            ),
        ),
    )

    @made.check(points=2)
    def starts(run: Run) -> None:
        """The service run starts the robot."""
        require_answers(run, '/run', [{'success': True, 'message': 'started'}], 'run')

    @made.check(points=2)
    def drives(run: Run) -> None:
        """The robot drives while it may and nothing is near."""
        require_endpoint(run, 'publisher', '/cmd_vel', TWIST)
        speeds = [one['data']['linear']['x'] for one in run.recording.messages('/cmd_vel')]
        moves = [one['data']['twist']['twist'] for one in run.recording.messages('/odom')]
        if speeds != [0.0, 0.5, 0.0] or [move['linear']['x'] for move in moves] != speeds:
            raise Failed(expected='speeds 0.0, 0.5, 0.0', observed=f'{speeds}, {moves}')

    return made


def test_twist_set_bool_scan_and_odometry_are_judged(exam):
    """The environment contains the packages that robotics courses use."""
    result = Engine(strongest()).run(exam, {'pilot.py': PILOT})

    assert [(check.verdict, check.observed) for check in result.checks] == [
        (Verdict.PASSED, '')
    ] * 2
    assert unsendable([exam]) == []


def test_missing_package_is_reported_with_the_file_that_names_packages(exam):
    """The name may be correct, and the learner has nothing to build."""
    program = PILOT.replace('from geometry_msgs', 'import toy_msgs\nfrom geometry_msgs')

    result = Engine(strongest()).run(exam, {'pilot.py': program})

    first = result.checks[0]
    assert first.verdict is Verdict.FAILED
    assert first.cause_id == 'message_not_built'
    assert 'environment/messages.txt' in first.try_this


def test_missing_package_of_a_scenario_is_no_verdict_and_named_with_the_file(exam):
    scenario = replace(exam.scenario, watch={'/toys': 'toy_msgs/msg/Toy'})

    with pytest.raises(ProbeFailed, match=r"'toy_msgs'\. Try: .* to environment/messages\.txt"):
        observe('pilot', scenario.to_json(), {'pilot.py': PILOT}, strongest())
