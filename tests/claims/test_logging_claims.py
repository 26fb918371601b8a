"""Test claims about logging, parameters and testing with the real rclpy."""

import math
import os
from pathlib import Path
import subprocess
import sys

import pytest
from rcl_interfaces.msg import (
    FloatingPointRange,
    Log,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.context import Context
from rclpy.exceptions import ParameterAlreadyDeclaredException, ParameterNotDeclaredException
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String

claim = pytest.mark.claim
pytestmark = pytest.mark.ros


@pytest.fixture
def rosout(world):
    """Return a growing list of the world's messages on /rosout."""
    heard = []
    profile = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    world.node('ear').create_subscription(Log, '/rosout', heard.append, profile)
    return heard


@claim('P1')
def test_severities_and_the_default(world):
    """Levels are ten apart, and INFO is the default threshold."""
    assert [level.value for level in LoggingSeverity][1:] == [10, 20, 30, 40, 50]
    log = world.node('quiet').get_logger()

    assert log.get_effective_level() == LoggingSeverity.INFO
    child = log.get_child('part')
    log.set_level(LoggingSeverity.ERROR)
    assert child.get_effective_level() == LoggingSeverity.ERROR


@claim('P2', 'P6')
def test_what_is_logged_is_published_and_debug_is_not(world, rosout):
    log = world.node('talker').get_logger()
    log.debug('not even sent')
    log.info('sent')
    world.spin_until(lambda: any(entry.msg == 'sent' for entry in rosout), what='the line')

    assert [entry.msg for entry in rosout if entry.name == 'talker'] == ['sent']


@claim('P2')
def test_what_is_logged_is_kept_in_a_file(tmp_path):
    """ROS_LOG_DIR determines the folder."""
    text = 'import rclpy\nrclpy.init(args=[])\nrclpy.create_node("a").get_logger().info("kept")\n'
    subprocess.run(
        [sys.executable, '-c', text],
        env={**os.environ, 'ROS_LOG_DIR': str(tmp_path)},
        check=True,
        capture_output=True,
    )

    assert any('kept' in path.read_text() for path in Path(tmp_path).rglob('*.log'))


@claim('P3', 'C20')
def test_warning_is_the_method(world, rosout):
    world.node('talker').get_logger().warning('hot')
    world.spin_until(lambda: any(e.msg == 'hot' for e in rosout), what='the warning')

    assert [e.level for e in rosout if e.msg == 'hot'] == [30]


@claim('P4')
def test_log_takes_one_text(world):
    """Format arguments and other types are refused."""
    log = world.node().get_logger()

    with pytest.raises(TypeError):
        log.info('%s degrees', 5)
    with pytest.raises(TypeError):
        log.info(5)


@claim('P5', 'P9')
def test_call_site_can_be_limited(world, rosout):
    """The options log only the first call, all but the first, and one call per long period."""
    log = world.node('talker').get_logger()
    for number in range(10):
        log.info(f'once {number}', once=True)
        log.info(f'skip {number}', skip_first=True)
        log.info(f'throttle {number}', throttle_duration_sec=3600.0)
    log.info('end')
    world.spin_until(lambda: any(e.msg == 'end' for e in rosout), what='the end')
    said = [e.msg.split()[0] for e in rosout if e.name == 'talker']

    assert [said.count(word) for word in ('once', 'skip', 'throttle')] == [1, 9, 1]


@claim('P5')
def test_call_site_keeps_its_severity(world):
    """A call site that has logged at one level refuses a different level."""
    log = world.node().get_logger()

    def say(level):
        getattr(log, level)('the same line')

    say('info')
    with pytest.raises(ValueError, match='severity'):
        say('warning')


@claim('P7', 'C30')
def test_parameter_has_one_declaration_and_one_type(world):
    """A second declaration, a missing declaration and a different type are refused."""
    node = world.node(parameter_overrides=[Parameter('threshold', value=28.5)])
    with pytest.raises(ParameterNotDeclaredException):
        node.get_parameter('threshold')
    node.declare_parameter('threshold', 30.0)

    assert node.get_parameter('threshold').value == 28.5
    with pytest.raises(ParameterAlreadyDeclaredException):
        node.declare_parameter('threshold', 30.0)
    (answer,) = node.set_parameters([Parameter('threshold', value=31)])
    assert not answer.successful
    assert 'DOUBLE' in answer.reason


@claim('P7')
def test_parameter_is_validated_in_a_callback(world):
    """A refusal keeps the old value and gives its reason."""
    node = world.node()
    node.declare_parameter('threshold', 30.0)
    node.add_on_set_parameters_callback(
        lambda new: SetParametersResult(
            successful=all(math.isfinite(p.value) for p in new), reason='not a number'
        )
    )
    (answer,) = node.set_parameters([Parameter('threshold', value=math.nan)])

    assert (answer.successful, answer.reason) == (False, 'not a number')
    assert node.get_parameter('threshold').value == 30.0


@claim('P12')
def test_nan_passes_a_test_of_what_is_below_or_above(world):
    """Such a node accepts NaN and never warns again; a range in a descriptor refuses NaN."""
    node, limit = world.node(), 'limit_c'
    node.declare_parameter(limit, 30.0)
    node.add_on_set_parameters_callback(
        lambda new: SetParametersResult(
            successful=not any(p.value < -40.0 or p.value > 125.0 for p in new)
        )
    )
    careful = FloatingPointRange(from_value=-40.0, to_value=125.0)
    node.declare_parameter('ranged', 30.0, ParameterDescriptor(floating_point_range=[careful]))
    wanted = [Parameter(name, value=math.nan) for name in (limit, 'ranged')]

    assert [answer.successful for answer in node.set_parameters(wanted)] == [True, False]
    assert not node.get_parameter(limit).value < 1000.0
    assert not -40.0 <= math.nan <= 125.0


@claim('P13')
def test_callback_of_parameters_is_asked_after_the_type(world):
    """The callback gets declarations and all parameters, but never a value of the wrong type."""
    node, asked = world.node(), []

    def note(parameters):
        asked.extend((one.name, one.value) for one in parameters)
        return SetParametersResult(successful=True)

    node.add_on_set_parameters_callback(note)
    node.declare_parameter('limit_c', 30.0)
    node.declare_parameter('place', 'motor')
    others = [Parameter('limit_c', value=value) for value in (29, 'hot', True)]

    assert not any(answer.successful for answer in node.set_parameters(others))
    assert node.set_parameters([Parameter('place', value='pump')])[0].successful
    assert asked == [('limit_c', 30.0), ('place', 'motor'), ('place', 'pump')]


@claim('P13')
@pytest.mark.filterwarnings('ignore:Callback returned an invalid type')
def test_callback_of_parameters_must_return_a_result(world):
    """Without a result, the change is refused, and rclpy gives the reason."""
    node = world.node()
    node.declare_parameter('limit_c', 30.0)
    node.add_on_set_parameters_callback(lambda parameters: None)
    (answer,) = node.set_parameters([Parameter('limit_c', value=31.0)])

    assert (answer.successful, answer.reason) == (False, 'Callback returned an invalid type')
    assert node.get_parameter('limit_c').value == 30.0


@claim('P8', 'C16', 'C32')
def test_edges_of_a_threshold():
    """30.0 is not above 30.0, NaN never is, and a slow random walk rarely crosses 30."""
    assert not 30.0 > 30.0
    assert not math.nan > 30.0
    # With steps of at most 0.5 from 20, a walk of two minutes can cross 30, but rarely does.
    import random

    warm = sum(crosses(random.Random(seed), seconds=120) for seed in range(500))
    assert warm < 25


def crosses(draw, seconds: int) -> bool:
    """Return whether a random walk with measurement noise exceeds 30 degrees."""
    value = 20.0
    for _ in range(seconds):
        value += draw.uniform(-0.5, 0.5)
        if value + draw.uniform(-2.0, 2.0) > 30.0:
            return True
    return False


@claim('P10')
def test_only_what_is_published_after_the_match_arrives(world):
    """A test that publishes before the match tests nothing; its wait needs a time limit."""
    heard, bench = [], world.node('bench')
    publisher = bench.create_publisher(String, 'readings', 10)
    publisher.publish(String(data='too early'))
    with pytest.raises(AssertionError, match='waited 0 s for a subscription'):
        world.spin_until(publisher.get_subscription_count, timeout=0, what='a subscription')

    world.node('monitor').create_subscription(String, 'readings', heard.append, 10)
    world.spin_until(publisher.get_subscription_count, what='a subscription')
    publisher.publish(String(data='matched'))
    world.spin_until(lambda: heard, what='a reading')

    assert [one.data for one in heard] == ['matched']


@claim('E12')
def test_world_of_a_test_is_its_own(world, other_world):
    """Two contexts on the domain of the test see each other, but no node in another domain."""
    stranger = Context()
    stranger.init(args=[], domain_id=world.another_domain)
    outside = Node('outside_of_this_test', context=stranger)
    here, _ = world.node('here'), other_world.node('there')
    world.spin_until(lambda: 'there' in here.get_node_names(), what='the other')

    assert 'outside_of_this_test' not in here.get_node_names()
    outside.destroy_node()
    stranger.try_shutdown()


@claim('P11')
def test_logic_is_tried_without_ros():
    """The decision of the course's monitor is a plain function of two numbers and a unit."""
    text = (
        "import sys\nfrom temp_monitor_pkg.threshold import *\nassert 'rclpy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, '-c', text], check=True, capture_output=True)


@pytest.fixture
def warned(world, rosout):
    """Return a function that sends numbers to a monitor and returns those that cause a warning."""

    def warned_of(numbers, is_hot, last=99.0):
        name = f'monitor_{len(world.nodes)}'
        monitor, bench = world.node(name), world.node(f'{name}_bench')
        monitor.create_subscription(
            Float64,
            name,
            lambda one: monitor.get_logger().warning(f'{one.data}') if is_hot(one.data) else None,
            10,
        )
        publisher = bench.create_publisher(Float64, name, 10)
        world.spin_until(publisher.get_subscription_count, what='a subscription')
        for number in (*numbers, last):
            publisher.publish(Float64(data=number))

        def lines():
            return [float(entry.msg) for entry in rosout if entry.name == name]

        world.spin_until(lambda: last in lines(), what='the last warning')
        return lines()

    return warned_of


@claim('P14')
def test_right_and_wrong_node_differ_at_the_limit_only(warned):
    right, wrong = (lambda value: value > 30.0), (lambda value: value >= 30.0)

    assert warned([29.9, 30.1, -40.0], right) == warned([29.9, 30.1, -40.0], wrong)
    assert warned([30.0], right) == [99.0]
    assert warned([30.0], wrong) == [30.0, 99.0]


@claim('P15')
def test_answer_to_a_later_message_comes_after_that_to_an_earlier_one(warned):
    """So a test that has the later response need not wait for the earlier one."""
    assert warned([31.0, 20.0, 32.0], lambda value: value > 30.0) == [31.0, 32.0, 99.0]
