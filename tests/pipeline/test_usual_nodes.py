"""Exams for common nodes need thirty lines, and name the cause of each mistake."""

import importlib

import pytest

from autograder.grading.examine import Engine
from autograder.sandboxes.choose import strongest

NODE = """
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Int32
from std_srvs.srv import SetBool, Trigger
rclpy.init()
node = Node('{name}')
{body}
rclpy.spin(node)
"""
LIMITER = """
node.declare_parameter('limit', 0.5)
out = node.create_publisher(Twist, 'cmd_vel', 10)
def hear(message):
    limit = node.get_parameter('limit').value
    message.linear.x = {cut}
    out.publish(message)
node.create_subscription(Twist, 'wanted', hear, 10)
"""
LAMP = """
state = [{first}]
def switch(request, response):
    response.success = {success}
    state[0] = request.data
    return response
node.create_service(SetBool, 'switch', switch)
"""
BUTTON = """
out = node.create_publisher(Bool, 'pressed', 10)
seen, last = [], [False]
def hear(message):
    seen.append(message.data)
    if {condition}:
        last[0] = message.data
        out.publish(message)
node.create_subscription(Bool, 'button', hear, 10)
"""
PULSES = """
node.declare_parameter('first', {first})
node.declare_parameter('period_s', 0.2)
out, state = node.create_publisher(Int32, 'count', 10), [False, 0]
def tick():
    if {condition}:
        state[1] += 1
        out.publish(Int32(data=state[1]))
def enable(request, response):
    state[0] = request.data
    {end}
node.create_timer({period}, tick)
node.create_service({kind}, '{service}', enable)
"""


def pulses(condition='state[0]', **other):
    given = {'first': 1, 'period': 0.2, 'kind': 'SetBool', 'service': 'enable'}
    given['end'] = 'response.success = True\n    return response'
    return PULSES.format(**{**given, 'condition': condition, **other})


AT_TIMES = (
    'node.create_service(SetBool',
    'node.create_timer(6.0, lambda: node.create_service(SetBool',
)
LATE = 'state[0] = state[0] and time.monotonic()\n    response.success = True\n    return response'
UNANSWERED = dict.fromkeys(('answers_enable', 'keeps_its_rhythm'), 'no_response_returned')
PROGRAMS = [
    ('speed_limiter', LIMITER.format(cut='max(-limit, min(message.linear.x, limit))'), 7, {}),
    (
        'speed_limiter',
        LIMITER.format(cut='min(message.linear.x, limit)'),
        4,
        {'publishes_cmd_vel': 'one_side'},
    ),
    (
        'speed_limiter',
        LIMITER.format(cut='message.linear.x'),
        4,
        {'publishes_cmd_vel': 'not_limited'},
    ),
    (
        'speed_limiter',
        LIMITER.format(cut='max(-0.5, min(message.linear.x, 0.5))'),
        4,
        {'publishes_cmd_vel': 'read_once'},
    ),
    (
        'speed_limiter',
        'node.create_publisher(Twist, "wanted", 10)',
        1,
        {'reads_and_writes': 'wrong_direction'},
    ),
    ('lamp', LAMP.format(first=False, success='request.data != state[0]'), 4, {}),
    (
        'lamp',
        LAMP.format(first=True, success='request.data != state[0]'),
        1,
        {'answers_switch': 'begins_on'},
    ),
    ('lamp', LAMP.format(first=False, success='True'), 1, {'answers_switch': 'never_refuses'}),
    ('lamp', '', 1, {'answers_switch': 'no_endpoint'}),
    ('pulse_counter', pulses(), 10, {}),
    ('pulse_counter', pulses(first=0), 9, {'declares': 'other_default'}),
    ('pulse_counter', pulses(first='1.0'), 9, {'declares': 'other_default'}),
    ('pulse_counter', pulses().replace("'first'", "'start'"), 9, {'declares': 'not_declared'}),
    ('pulse_counter', pulses(service='~/enable'), 3, {'serves_enable': 'private_name'}),
    ('pulse_counter', pulses(service='enabel'), 3, {'serves_enable': 'topic_name'}),
    (
        'pulse_counter',
        pulses(kind='Trigger', end='return response'),
        3,
        {'serves_enable': 'wrong_type'},
    ),
    (
        'pulse_counter',
        pulses(end='pass'),
        4,
        UNANSWERED,
    ),
    ('pulse_counter', pulses(end='return response'), 8, {'answers_enable': 'no_success'}),
    ('pulse_counter', pulses(condition='True'), 8, {'is_quiet': 'stays_on'}),
    (
        'pulse_counter',
        pulses(condition='state[0] and time.monotonic() - state[0] > 1', end=LATE),
        6,
        {'keeps_its_rhythm': 'begins_late'},
    ),
    (
        'pulse_counter',
        pulses(condition='False') + 'node.create_timer(5.0, lambda: None)',
        6,
        {'keeps_its_rhythm': ''},
    ),
    ('pulse_counter', pulses(end='return request'), 4, UNANSWERED),
    (
        'pulse_counter',
        pulses().replace(*AT_TIMES) + ')',
        4,
        {'answers_enable': 'service_at_times', 'keeps_its_rhythm': ''},
    ),
    ('pulse_counter', pulses(period=1.0), 6, {'keeps_its_rhythm': 'wrong_rate'}),
    ('pulse_counter', pulses(period='5.0'), 6, {'keeps_its_rhythm': 'wrong_rate'}),
    (
        'debouncer',
        BUTTON.format(condition='len(set(seen[-2:])) == 1 < len(seen) and seen[-1] != last[0]'),
        7,
        {},
    ),
    ('debouncer', BUTTON.format(condition='seen[-1] != last[0]'), 3, {'one_for_one': 'no_wait'}),
    ('debouncer', BUTTON.format(condition='True'), 3, {'one_for_one': 'passes_all'}),
    (
        'debouncer',
        BUTTON.format(condition='len(seen) % 2 == 0'),
        3,
        {'one_for_one': 'several_answers'},
    ),
]


@pytest.mark.parametrize(('name', 'body', 'points', 'causes'), PROGRAMS)
def test_program_gets_its_points_and_its_cause(name, body, points, causes):
    exam = importlib.import_module(f'tests.pipeline.usual_exams.{name}').exam

    result = Engine(strongest()).run(exam, {f'{name}.py': NODE.format(name=name, body=body)})

    assert {check.check: check.cause_id for check in result.failed} == causes
    assert result.points == points


@pytest.mark.parametrize('name', ['speed_limiter', 'lamp', 'debouncer', 'pulse_counter'])
def test_inputs_tell_each_mistake_from_the_others(name):
    """``release --check`` requires this of every exam."""
    exam = importlib.import_module(f'tests.pipeline.usual_exams.{name}').exam

    assert [one for asked in exam.asks.values() for one in asked.mistakes()] == []
