"""Test claims about topics, names and discovery with the real rclpy."""

import os
import subprocess
import sys

import pytest
from rclpy.context import Context
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.serialization import serialize_message
from rclpy.utilities import get_rmw_implementation_identifier
from std_msgs.msg import Int32, String

claim = pytest.mark.claim
pytestmark = pytest.mark.ros


@claim('T1', 'C10')
def test_publishers_and_subscriptions_are_no_nodes(world):
    node = world.node('owner')
    node.create_publisher(String, 'a', 10)
    node.create_publisher(String, 'b', 10)
    node.create_subscription(String, 'c', lambda _: None, 10)

    assert node.get_node_names() == ['owner']


@claim('T2')
def test_topic_joins_many_with_many(world):
    """Each subscription receives from both publishers; publishing to none is not an error."""
    node, heard = world.node(), {1: [], 2: []}
    publishers = [node.create_publisher(String, 'chatter', 10) for _ in range(2)]
    publishers[0].publish(String(data='to nobody'))
    for number in heard:
        node.create_subscription(
            String, 'chatter', lambda m, number=number: heard[number].append(m.data), 10
        )
    for number, publisher in enumerate(publishers):
        publisher.publish(String(data=str(number)))
    world.spin_until(lambda: all(len(all_) == 2 for all_ in heard.values()), what='all messages')

    assert heard[1] == heard[2] == ['0', '1']


@claim('T4', 'T5')
def test_names_are_expanded(world):
    """Relative, absolute and private names are resolved in the namespace lab."""
    node = world.node('a', namespace='lab')

    assert node.resolve_topic_name('rel') == '/lab/rel'
    assert node.resolve_topic_name('/abs') == '/abs'
    assert node.resolve_topic_name('~/priv') == '/lab/a/priv'


@claim('T4')
@pytest.mark.parametrize('name', ['', '1st', 'two words', 'a//b', 'a/', 'a-b'])
def test_bad_topic_names_are_refused(world, name):
    with pytest.raises((InvalidTopicNameException, ValueError)):
        world.node().create_publisher(String, name, 10)


@claim('T6')
def test_what_is_sent_before_the_match_is_lost(world, other_world):
    talker, heard = world.node('talker'), []
    publisher = talker.create_publisher(String, 'chatter', 10)
    publisher.publish(String(data='too early'))
    other_world.node('listener').create_subscription(String, 'chatter', heard.append, 10)
    world.spin_until(lambda: publisher.get_subscription_count() == 1, what='the match')
    publisher.publish(String(data='in time'))
    other_world.spin_until(lambda: heard, what='the second message')

    assert [message.data for message in heard] == ['in time']


@claim('T7')
def test_endpoints_of_one_context_match_at_once(world):
    publisher = world.node('talker').create_publisher(String, 'chatter', 10)
    world.node('listener').create_subscription(String, 'chatter', lambda _: None, 10)

    assert publisher.get_subscription_count() == 1


@claim('T8')
def test_node_hears_itself(world):
    node, heard = world.node(), []
    node.create_subscription(String, 'chatter', heard.append, 10)
    node.create_publisher(String, 'chatter', 10).publish(String(data='me'))

    world.spin_until(lambda: heard, what='its own message')


@claim('T9')
def test_second_type_in_one_participant_is_an_error_with_other_words(world):
    """The error message mentions an allocator."""
    node = world.node()
    node.create_publisher(String, 'chatter', 10)

    with pytest.raises(Exception, match=r'(?i)allocator|type'):
        node.create_subscription(Int32, 'chatter', lambda _: None, 10)


@claim('T9')
def test_two_types_in_two_participants_are_silent(world, other_world):
    """Both participants see the topic with both types, but the endpoints never match."""
    publisher = world.node('talker').create_publisher(String, 'chatter', 10)
    listener = other_world.node('listener')
    listener.create_subscription(Int32, 'chatter', lambda _: None, 10)
    # A second pair with equal types shows that discovery of the first pair is complete.
    control = world.node('control').create_publisher(Int32, 'control', 10)
    listener.create_subscription(Int32, 'control', lambda _: None, 10)
    world.spin_until(lambda: control.get_subscription_count() == 1, what='the control')
    world.spin_until(
        lambda: len(dict(listener.get_topic_names_and_types())['/chatter']) == 2, what='both types'
    )

    assert publisher.get_subscription_count() == 0


@claim('T10')
@pytest.mark.parametrize('domain', [0, 101, 232])
def test_domain_ids_that_can_be_had(domain):
    """Ids from 0 to 101 are safe; 232 is the highest that the port numbers allow."""
    context = Context()
    context.init(args=[], domain_id=domain)
    node = Node('there', context=context)

    assert context.get_domain_id() == domain
    node.destroy_node()
    context.shutdown()


@claim('T10')
def test_domain_id_beyond_the_ports_ends_the_process():
    """The middleware exits instead of raising, so the test uses a child process."""
    text = (
        'import rclpy\nfrom rclpy.context import Context\nfrom rclpy.node import Node\n'
        'context = Context()\ncontext.init(args=[], domain_id=233)\n'
        'Node("beyond", context=context)\n'
    )
    tried = subprocess.run(
        [sys.executable, '-c', text], capture_output=True, text=True, check=False
    )

    assert tried.returncode == 1
    assert 'domainId is over 232' in tried.stdout + tried.stderr


@claim('T11', 'T12')
def test_other_programs_of_the_domain_are_found_unless_discovery_is_off(world):
    """A neighbour in the same domain appears; a node with discovery range OFF does not."""
    watcher = world.node('watcher')
    domain = {'ROS_DOMAIN_ID': str(world.context.get_domain_id())}
    deaf = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF'}
    with neighbour('quiet', **domain, **deaf), neighbour('loud', **domain):
        world.spin_until(lambda: 'loud' in watcher.get_node_names(), what='the neighbour')
        assert 'quiet' not in watcher.get_node_names()


class neighbour:  # noqa: N801 - reads like a function
    """Run a program with one node during the block; the node exists when the block begins."""

    def __init__(self, name, **environment):
        text = (
            'import rclpy, sys\nrclpy.init(args=[])\n'
            f'node = rclpy.create_node({name!r})\nprint("up", flush=True)\nsys.stdin.read()\n'
        )
        self.process = subprocess.Popen(
            [sys.executable, '-c', text],
            env={**os.environ, **environment},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert self.process.stdout.readline() == b'up\n'

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.communicate(timeout=60)


@claim('T14')
def test_middleware_is_chosen_by_name():
    """The error names a middleware that is not installed."""
    assert get_rmw_implementation_identifier() == 'rmw_fastrtps_cpp'
    asked = subprocess.run(
        [sys.executable, '-c', 'import rclpy; rclpy.init(args=[])'],
        env={**os.environ, 'RMW_IMPLEMENTATION': 'rmw_not_here'},
        capture_output=True,
        text=True,
        check=False,
    )

    assert asked.returncode != 0
    assert 'rmw_not_here' in asked.stdout + asked.stderr


@claim('T15')
def test_publish_takes_its_type_or_bytes(world):
    """Bytes are sent unchanged; a different type is refused."""
    node, heard = world.node(), []
    node.create_subscription(String, 'chatter', heard.append, 10)
    publisher = node.create_publisher(String, 'chatter', 10)
    publisher.publish(serialize_message(String(data='raw')))
    world.spin_until(lambda: heard, what='the message')
    assert heard[0].data == 'raw'

    with pytest.raises(TypeError):
        publisher.publish(Int32(data=1))
    with pytest.raises(TypeError):
        publisher.publish('text')
