"""Test claims about quality of service with real endpoints and real events."""

import pytest
from rclpy.duration import Duration
from rclpy.event_handler import (
    PublisherEventCallbacks,
    QoSPublisherEventType,
    QoSSubscriptionEventType,
    SubscriptionEventCallbacks,
    UnsupportedEventTypeError,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    qos_check_compatible,
    qos_policy_name_from_kind,
    qos_profile_parameters,
    qos_profile_sensor_data,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Int32, String

claim = pytest.mark.claim
pytestmark = pytest.mark.ros

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def numbers(publisher, upto):
    for number in range(upto):
        publisher.publish(Int32(data=number))


@claim('Q1')
def test_ten_stands_for_a_whole_profile(world):
    """The number 10 means keep last 10, reliable and volatile."""
    profile = world.node().create_publisher(String, 'a', 10).qos_profile

    assert (profile.history, profile.depth) == (HistoryPolicy.KEEP_LAST, 10)
    assert profile.reliability == ReliabilityPolicy.RELIABLE
    assert profile.durability == DurabilityPolicy.VOLATILE


@claim('Q2')
def test_profile_needs_a_depth(world):
    """An empty profile, keep last without a depth and a negative depth are refused."""
    for options in ({}, {'history': HistoryPolicy.KEEP_LAST}):
        with pytest.raises(InvalidQoSProfileException):
            QoSProfile(**options)
    with pytest.raises(ValueError, match=r'(?i)depth|negative'):
        world.node().create_publisher(String, 'a', -1)


@claim('Q3')
def test_presets():
    """Sensor data and parameters differ in more than their names."""
    assert qos_profile_sensor_data.reliability == ReliabilityPolicy.BEST_EFFORT
    assert qos_profile_sensor_data.depth == 5
    assert qos_profile_parameters.depth == 1000


@claim('Q4', 'Q6', 'C13')
def test_offer_must_be_as_strong_as_the_request():
    """A weak offer with a strong request is an ERROR with a reason; the reverse is OK."""
    verdict, reason = qos_check_compatible(BEST_EFFORT, QoSProfile(depth=10))
    assert verdict == QoSCompatibility.ERROR
    assert 'reliab' in reason.lower()
    strong = QoSProfile(depth=10, liveliness=LivelinessPolicy.AUTOMATIC)
    weak = QoSProfile(
        depth=10,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        liveliness=LivelinessPolicy.AUTOMATIC,
    )
    assert qos_check_compatible(strong, weak)[0] == QoSCompatibility.OK


@claim('Q5', 'C13')
def test_depth_history_and_lifespan_do_not_matter_for_matching(world):
    node = world.node()
    publisher = node.create_publisher(
        String, 'a', QoSProfile(depth=1, lifespan=Duration(seconds=1))
    )
    node.create_subscription(
        String, 'a', lambda _: None, QoSProfile(history=HistoryPolicy.KEEP_ALL)
    )

    assert publisher.get_subscription_count() == 1


@claim('Q7', 'Q8', 'Q18', 'C15')
def test_incompatible_pair_exists_and_is_not_matched(world):
    """The pair is in the graph but not connected; spinning delivers an event with the policy."""
    node, events = world.node(), []
    publisher = node.create_publisher(
        String,
        'a',
        BEST_EFFORT,
        event_callbacks=PublisherEventCallbacks(incompatible_qos=events.append),
    )
    node.create_subscription(
        String,
        'a',
        lambda _: None,
        10,
        event_callbacks=SubscriptionEventCallbacks(incompatible_qos=events.append),
    )
    assert node.count_subscribers('/a') == 1
    assert publisher.get_subscription_count() == 0
    assert events == []  # no node has been spun
    world.spin_until(lambda: len(events) == 2, what='an event on each side')
    for event in events:
        assert (event.total_count, event.total_count_change) == (1, 1)
        assert qos_policy_name_from_kind(event.last_policy_kind) == 'RELIABILITY'


@claim('Q7')
def test_incompatible_pair_warns_on_both_sides_by_itself(world, capfd):
    """Without event callbacks, two lines are logged, and both name the policy."""
    node = world.node()
    node.create_publisher(String, 'a', BEST_EFFORT)
    node.create_subscription(String, 'a', lambda _: None, 10)
    said = []

    def both():
        captured = capfd.readouterr()
        said.append(captured.out + captured.err)
        return ''.join(said).count('RELIABILITY') >= 2

    world.spin_until(both, what='two warnings')


@claim('Q9', 'C11')
def test_reliable_burst_into_a_full_queue(world):
    """Of a hundred messages, a subscription of depth ten that is not spun keeps the last ten."""
    node, heard = world.node(), []
    publisher = node.create_publisher(Int32, 'a', 10)
    node.create_subscription(Int32, 'a', lambda m: heard.append(m.data), 10)
    numbers(publisher, 100)
    world.spin_until(lambda: 99 in heard, what='the last')

    assert heard == list(range(90, 100))


@claim('Q10')
def test_depth_three_keeps_three(world):
    node, heard = world.node(), []
    publisher = node.create_publisher(Int32, 'a', 10)
    node.create_subscription(Int32, 'a', lambda m: heard.append(m.data), 3)
    numbers(publisher, 10)
    world.spin_until(lambda: 9 in heard, what='the last')

    assert heard == [7, 8, 9]


@claim('Q11', 'C12')
def test_late_joiners_need_transient_local_on_both_sides(world):
    """A transient local subscription gets the last messages; a volatile one gets only new ones."""
    node, latched, volatile = world.node(), [], []
    publisher = node.create_publisher(Int32, 'map', LATCHED)
    numbers(publisher, 10)
    node.create_subscription(Int32, 'map', lambda m: volatile.append(m.data), 10)
    node.create_subscription(Int32, 'map', lambda m: latched.append(m.data), LATCHED)
    world.spin_until(lambda: latched == [7, 8, 9], what='the three last')
    publisher.publish(Int32(data=10))
    world.spin_until(lambda: volatile, what='a new one')

    assert volatile == [10]


@claim('Q11', 'C12')
def test_past_ends_with_its_publisher(world):
    node, heard = world.node(), []
    first = node.create_publisher(Int32, 'map', LATCHED)
    first.publish(Int32(data=1))
    node.destroy_publisher(first)
    node.create_publisher(Int32, 'map', LATCHED).publish(Int32(data=2))
    node.create_subscription(Int32, 'map', lambda m: heard.append(m.data), LATCHED)
    world.spin_until(lambda: heard, what='what is left')

    assert heard == [2]


@claim('Q12')
def test_missed_deadline_is_reported_on_both_sides(world):
    node, offered, requested = world.node(), [], []
    profile = QoSProfile(depth=1, deadline=Duration(seconds=0.05))
    publisher = node.create_publisher(
        String,
        'a',
        profile,
        event_callbacks=PublisherEventCallbacks(deadline=offered.append),
    )
    node.create_subscription(
        String,
        'a',
        lambda _: None,
        profile,
        event_callbacks=SubscriptionEventCallbacks(deadline=requested.append),
    )
    publisher.publish(String())
    world.spin_until(lambda: len(offered) >= 2 and len(requested) >= 2, what='missed deadlines')

    assert requested[-1].total_count >= 2


@claim('Q13')
def test_manual_liveliness_is_lost_and_regained(world):
    node, changes = world.node(), []
    profile = QoSProfile(
        depth=1,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=0.1),
    )
    publisher = node.create_publisher(String, 'a', profile)
    node.create_subscription(
        String,
        'a',
        lambda _: None,
        profile,
        event_callbacks=SubscriptionEventCallbacks(liveliness=changes.append),
    )

    def alive():
        publisher.assert_liveliness()
        return changes and changes[-1].alive_count == 1

    # Repeat, because a busy machine may report loss and return as one change.
    world.spin_until(alive, what='a sign of life')
    world.spin_until(lambda: changes[-1].not_alive_count == 1, what='its loss')
    world.spin_until(alive, what='its return')


@claim('Q14')
def test_old_messages_expire(world):
    node, heard, ticks = world.node(), [], []
    mortal = QoSProfile(
        depth=10,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(seconds=0.1),
    )
    immortal = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(Int32, 'mortal', mortal).publish(Int32(data=1))
    node.create_publisher(Int32, 'immortal', immortal).publish(Int32(data=2))
    node.create_timer(0.3, lambda: ticks.append(1))
    world.spin_until(lambda: ticks, what='three lifespans')
    for topic in ('mortal', 'immortal'):
        node.create_subscription(Int32, topic, lambda m: heard.append(m.data), immortal)
    world.spin_until(lambda: heard, what='the other')

    assert heard == [2]


@claim('Q14')
def test_messages_in_a_queue_expire_by_the_lifespan_of_the_subscription(world):
    """With a lifespan only on the publisher, messages stay in the queue."""
    node, sleeper = world.node(), Node('sleeper', context=world.context)
    world.nodes.append(sleeper)
    mortal, immortal = QoSProfile(depth=10, lifespan=Duration(seconds=0.1)), QoSProfile(depth=10)
    heard = {'publisher': [], 'subscription': [], 'both': []}
    publishers = []
    for topic, (offer, request) in {
        'publisher': (mortal, immortal),
        'subscription': (immortal, mortal),
        'both': (mortal, mortal),
    }.items():
        take = heard[topic].append
        sleeper.create_subscription(Int32, topic, lambda m, take=take: take(m.data), request)
        publishers.append(node.create_publisher(Int32, topic, offer))
        publishers[-1].publish(Int32(data=1))
    ticks = []
    node.create_timer(0.3, lambda: ticks.append(1))
    world.spin_until(lambda: ticks, what='three lifespans')
    world.executor.add_node(sleeper)
    for publisher, got in zip(publishers, heard.values()):
        # Repeat, because on a busy machine this message may expire, too.
        world.spin_until(
            lambda: publisher.publish(Int32(data=2)) or 2 in got,  # noqa: B023 - used at once
            what='a new message',
        )

    assert {topic: 1 in got for topic, got in heard.items()} == {
        'publisher': True,
        'subscription': False,
        'both': False,
    }


@claim('Q15')
def test_matched_events_count_on_both_sides(world):
    """The count rises by one when a subscription appears, and falls by one when it disappears."""
    node, matched = world.node(), []
    node.create_publisher(
        String, 'a', 10, event_callbacks=PublisherEventCallbacks(matched=matched.append)
    )
    subscription = node.create_subscription(String, 'a', lambda _: None, 10)
    world.spin_until(lambda: matched, what='the match')
    node.destroy_subscription(subscription)
    world.spin_until(lambda: len(matched) == 2, what='the parting')

    assert [(m.current_count, m.current_count_change) for m in matched] == [(1, 1), (0, -1)]


@claim('Q16', 'Q17')
def test_events_depend_on_the_middleware(world):
    """Each kind of event is either accepted or refused by name; message lost is accepted here."""
    node, refused = world.node(), []
    kinds = {
        'deadline': lambda _: None,
        'liveliness': lambda _: None,
        'message_lost': lambda _: None,
        'incompatible_type': lambda _: None,
        'matched': lambda _: None,
    }
    for kind, callback in kinds.items():
        try:
            node.create_subscription(
                String,
                'a',
                lambda _: None,
                10,
                event_callbacks=SubscriptionEventCallbacks(**{kind: callback}),
            )
        except UnsupportedEventTypeError:
            refused.append(kind)

    assert refused in ([], ['incompatible_type'])
    assert QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST
    assert QoSPublisherEventType.RCL_PUBLISHER_MATCHED


@claim('Q19')
def test_parameters_override_qos(world):
    """A node that allows overrides takes its queue depth from a parameter."""
    node = world.node(
        parameter_overrides=[Parameter('qos_overrides./a.publisher.depth', value=42)]
    )
    publisher = node.create_publisher(
        String, 'a', 10, qos_overriding_options=QoSOverridingOptions.with_default_policies()
    )

    assert publisher.qos_profile.depth == 42


@claim('Q21')
def test_profile_of_rosout(world):
    """A late subscription gets the lines of the last ten seconds."""
    node = world.node('logger')
    (info,) = node.get_publishers_info_by_topic('/rosout')

    assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert info.qos_profile.lifespan == Duration(seconds=10)
