"""Scenarios as data: they contain only the instructions to the probe."""

import json

import pytest

from autograder.exam.scenario import FeedTopic, RosClock, Scenario
from autograder.exam.steps import (
    Advance,
    Call,
    EVERYONE,
    Feed,
    Join,
    Leave,
    Look,
    Mark,
    Offer,
    Qos,
    set_parameters,
    state,
    transition,
    Watch,
)

STEPS = [
    Advance(2.5),
    Feed('/in', [{'data': 'a'}]),
    Call('/talker', 'get_parameters', 'rcl_interfaces/srv/GetParameters', {'names': ['rate']}),
    Join('late', '/out', 'std_msgs/msg/String', Qos(durability='TRANSIENT_LOCAL')),
    Offer('sensor', '/in', 'std_msgs/msg/String', Qos(deadline_s=0.3)),
    Leave('late'),
    Watch('/out'),
    Mark('second'),
    Look('second'),
]


def test_every_step_is_json():
    data = Scenario(steps=STEPS).to_json()

    assert json.loads(json.dumps(data))['steps'] == data['steps']
    assert [step['do'] for step in data['steps']] == [
        *('advance', 'feed', 'call', 'join', 'offer', 'leave', 'watch', 'mark', 'look')
    ]


@pytest.mark.parametrize(
    ('virtual_s', 'ros_s'), [(0.0, 100.0), (0.124, 100.0), (0.125, 100.25), (3.0, 106.0)]
)
def test_ros_time_is_that_of_the_last_message_on_its_topic(virtual_s, ros_s):
    """If ROS time runs at twice the computer's speed, a step of 0.25 s takes 0.125 s."""
    clock = RosClock(begins_s=100.0, rate=2.0, step_s=0.25)

    assert clock.at(round(virtual_s * 1e9)) == round(ros_s * 1e9)


def test_service_is_named_after_its_node_unless_it_is_full():
    assert state('/lab/thermometer').to_json()['service'] == '/lab/thermometer/get_state'
    assert Call('/talker', '/reset', 'a/srv/B').to_json()['service'] == '/reset'


def test_feed_without_quality_of_service_suits_everyone():
    mine = FeedTopic('std_msgs/msg/String', Qos('BEST_EFFORT', depth=1))

    feed = Scenario(feed={'/a': 'std_msgs/msg/String', '/b': mine}).to_json()['feed']

    assert feed['/a']['qos']['durability'] == EVERYONE.durability == 'TRANSIENT_LOCAL'
    usual = {'durability': 'VOLATILE', 'liveliness': 'AUTOMATIC'}
    unset = dict.fromkeys(['deadline_s', 'lifespan_s', 'lease_s'])
    qos = {**usual, **unset, 'reliability': 'BEST_EFFORT', 'depth': 1}
    assert feed['/b'] == {'type': 'std_msgs/msg/String', 'qos': qos}


@pytest.mark.parametrize(
    ('value', 'sent'),
    [
        (True, {'type': 1, 'bool_value': True}),
        (3, {'type': 2, 'integer_value': 3}),
        (28.5, {'type': 3, 'double_value': 28.5}),
        ('lab', {'type': 4, 'string_value': 'lab'}),
    ],
    ids=['bool', 'int', 'float', 'str'],
)
def test_parameter_is_sent_with_its_type(value, sent):
    """The type numbers are those of rcl_interfaces/msg/ParameterType; a bool is not an int."""
    (parameter,) = set_parameters('/a', {'x': value}).to_json()['request']['parameters']

    assert parameter == {'name': 'x', 'value': sent}


def test_transitions_have_the_numbers_of_the_lifecycle():
    """The numbers are those of lifecycle_msgs/msg/Transition."""
    names = ('configure', 'cleanup', 'activate', 'deactivate')

    numbers = [transition('/a', name).to_json()['request']['transition']['id'] for name in names]

    assert numbers == [1, 2, 3, 4]
