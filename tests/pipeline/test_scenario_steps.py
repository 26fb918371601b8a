"""Test each step of a scenario with a small program in the sandbox and the probe."""

import pytest

from autograder.errors import ProbeFailed
from autograder.exam.scenario import FeedTopic
from autograder.exam.steps import (
    Advance,
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
    unheard,
)
from autograder.recording import WARN

STRING, INT = 'std_msgs/msg/String', 'std_msgs/msg/Int32'
SECOND = 1_000_000_000
pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]


def of_interest(recording, *kinds):
    """Return the events of some kinds, in order, by kind."""
    return [event['event'] for event in recording.events if event['event'] in kinds]


LATCHED = """
def make():
    node = Node('map')
    qos = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(Int32, '/map', qos)
    for number in range(8):
        publisher.publish(Int32(data=number))
    return node
"""


class TestJoin:
    def test_late_joiner_hears_the_history(self, run):
        """A transient-local subscription gets as many messages as the publisher's depth keeps."""
        late = Qos(durability='TRANSIENT_LOCAL')

        seen = run(LATCHED, Join('late', '/map', INT, late))

        found = seen.messages('/map', 'late')
        assert [event['data']['data'] for event in found] == [5, 6, 7]
        assert all(event['age_ns'] == event['clock_ns'] for event in found)
        assert seen.of('joined') == seen.of('joined', listener='late', matched=True, refused=[])
        assert seen.messages('/map') == []

    def test_volatile_listener_hears_nothing_of_the_past(self, run):
        seen = run(LATCHED, Join('late', '/map', INT, Qos()))

        assert [event['matched'] for event in seen.of('joined')] == [True]
        assert seen.messages('/map', 'late') == []

    def test_refused_listener_names_the_policy(self, run):
        """A best-effort publisher does not match a reliable subscription."""
        body = """
def make():
    node = Node('sensor')
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_publisher(Int32, '/values', qos)
    return node
"""
        seen = run(body, Join('strict', '/values', INT, Qos()))

        (joined,) = seen.of('joined')
        assert (joined['matched'], joined['refused']) == (False, ['RELIABILITY'])

    def test_leaving_is_noticed_by_the_student(self, run):
        """The student's node gets two matched events, one for each change, in separate phases."""
        body = """
from rclpy.event_handler import PublisherEventCallbacks

def make():
    node = Node('counter')
    seen = lambda info: node.get_logger().warning(f'{info.current_count} of {info.total_count}')
    events = PublisherEventCallbacks(matched=seen)
    node.create_publisher(Int32, '/values', 10, event_callbacks=events)
    return node
"""
        steps = [Mark('in'), Join('one', '/values', INT), Mark('out'), Leave('one')]

        seen = run(body, *steps)

        texts = {name: [log['text'] for log in seen.phase(name).logs()] for name in ('in', 'out')}
        assert texts == {'in': ['1 of 1'], 'out': ['0 of 1']}


THERMOMETER = """
class Thermometer(LifecycleNode):
    def on_configure(self, state):
        if self.get_parameter('limit').value < 0:
            self.get_logger().error('limit below zero')
            return TransitionCallbackReturn.FAILURE
        self.publisher = self.create_lifecycle_publisher(String, 'reading', 10)
        self.timer = self.create_timer(1.0, self.publish)
        return super().on_configure(state)

    def publish(self):
        self.publisher.publish(String(data='x'))


def make():
    node = Thermometer('thermometer')
    node.declare_parameter('limit', 30.0)
    return node
"""


class TestCall:
    def test_lifecycle_is_driven_from_outside(self, run):
        """Only the active phase has messages; the probe asks for the state at the end."""
        node = '/lab/thermometer'
        steps = [transition(node, 'configure'), Mark('inactive'), Advance(3)]
        steps += [transition(node, 'activate'), Mark('active'), Advance(3)]
        steps += [transition(node, 'deactivate'), Mark('silent'), Advance(3), state(node)]

        seen = run(
            THERMOMETER,
            *steps,
            arguments=('-r', '__ns:=/lab'),
            watch={'/lab/reading': STRING},
        )

        counts = {
            name: len(seen.phase(name).messages('/lab/reading'))
            for name in ('inactive', 'active', 'silent')
        }
        assert counts == {'inactive': 0, 'active': 3, 'silent': 0}
        changed = seen.answers(f'{node}/change_state')
        assert [answer['data'] for answer in changed] == [{'success': True}] * 3
        (asked,) = seen.answers(f'{node}/get_state')
        assert asked['data']['current_state']['label'] == 'inactive'
        assert seen.end_reason == 'complete'

    def test_graph_is_looked_at_in_between(self, run):
        """A publisher that a transition creates is only in the second graph."""
        steps = [Look('before'), transition('/thermometer', 'configure'), Look('after')]

        seen = run(THERMOMETER, *steps)

        topics = {
            graph['when']: [end for end in graph['endpoints'] if end['topic'] == '/reading']
            for graph in seen.of('graph')
        }
        assert [len(topics[when]) for when in ('start', 'before', 'after', 'end')] == [0, 0, 1, 1]

    def test_parameter_is_set_and_from_the_command_line(self, run):
        """FAILURE leaves the node unconfigured; a corrected parameter lets it configure."""
        node = '/thermometer'
        steps = [Mark('bad'), transition(node, 'configure')]
        steps += [
            Mark('good'),
            set_parameters(node, {'limit': 20.0}),
            transition(node, 'configure'),
        ]

        seen = run(THERMOMETER, *steps, arguments=('-p', 'limit:=-1.0'))

        assert [log['text'] for log in seen.phase('bad').logs()] == ['limit below zero']
        (setting,) = seen.answers(f'{node}/set_parameters')
        assert setting['data']['results'] == [{'successful': True, 'reason': ''}]
        changed = seen.answers(f'{node}/change_state')
        assert [answer['data']['success'] for answer in changed] == [False, True]

    def test_service_that_is_not_there_is_no_answer(self, run):
        """The run continues, because later steps may still give evidence."""
        seen = run(LATCHED, state('/map'), Mark('after'))

        (asked,) = seen.answers('/map/get_state')
        assert (asked['event'], asked['reason']) == ('no_answer', 'no_service')
        assert seen.phase('after').of('mark')

    def test_node_that_nobody_spins_does_not_answer(self, run):
        """A program may add only one of its two nodes to an executor."""
        body = """
def make():
    global silent
    silent = Node('silent')
    return Node('spun')
"""
        steps = [set_parameters(name, {'use_sim_time': False}) for name in ('/silent', '/spun')]

        seen = run(body, *steps)

        assert [event['reason'] for event in seen.of('no_answer')] == ['too_late']
        assert len(seen.of('answer')) == 1
        assert {event['node']: event['answered'] for event in seen.of('asked')} == {
            '/silent': False,
            '/spun': True,
        }

    def test_program_that_ends_in_a_call_is_no_answer(self, run):
        """The run does not contain the probe's later steps."""
        body = """
import os

class Fragile(LifecycleNode):
    def on_configure(self, state):
        os._exit(3)

def make():
    return Fragile('fragile')
"""
        seen = run(body, transition('/fragile', 'configure'), Mark('after'))

        assert seen.of('mark') == seen.answers('/fragile/change_state') == []
        assert seen.end_reason == 'student_exited'
        assert seen.process['exit'] == 3


LISTENER = """
def make():
    node = Node('listener')
    log = node.get_logger()
    events = SubscriptionEventCallbacks(
        deadline=lambda info: log.warning('late'),
        incompatible_qos=lambda info: log.error('refused'),
        liveliness=lambda info: log.info(f'alive {info.alive_count}'),
    )
    node.create_subscription(
        String, '/in', lambda message: log.info(message.data), QoSProfile(depth=10{options}),
        event_callbacks=events,
    )
    return node
"""


class TestOffer:
    def test_missed_deadlines_are_counted(self, run):
        """Deadlines run in virtual time, as everything else does."""
        body = LISTENER.replace('{options}', ', deadline=Duration(seconds=0.3)')
        promise = Qos(deadline_s=0.3)
        steps = [Offer('sensor', '/in', STRING, promise), Feed('sensor', [{'data': 'a'}])]

        seen = run(body, *steps, Mark('quiet'), Advance(1.5), Leave('sensor'))

        assert len(seen.phase('quiet').logs(level=WARN)) >= 5
        assert of_interest(seen, 'offered', 'left') == ['offered', 'left']

    def test_refused_publisher_names_the_policy(self, run):
        """Both sides report the refusal: the probe's event and the student's log."""
        body = LISTENER.replace('{options}', '')
        steps = [Offer('sensor', '/in', STRING, Qos('BEST_EFFORT'))]

        seen = run(body, *steps)

        (offered,) = seen.of('offered')
        assert (offered['matched'], offered['refused']) == (False, ['RELIABILITY'])
        assert [log['text'] for log in seen.logs()] == ['refused']

    def test_liveliness_changes_when_it_leaves(self, run):
        """The student's node gets the event; without a lease, Fast DDS would not send it."""
        body = LISTENER.replace('{options}', ', liveliness_lease_duration=Duration(seconds=2)')
        steps = [Offer('sensor', '/in', STRING, Qos(lease_s=2.0)), Advance(2.0)]
        steps += [Mark('gone'), Leave('sensor')]

        seen = run(body, *steps)

        assert [log['text'] for log in seen.logs()] == ['alive 1', 'alive 0']
        assert [log['text'] for log in seen.phase('gone').logs()] == ['alive 0']

    def test_feed_has_its_own_quality_of_service(self, run):
        """If a feed is best effort, no reliable subscription connects to it."""
        body = LISTENER.replace('{options}', '')
        feed = {'/in': FeedTopic(STRING, Qos('BEST_EFFORT'))}

        seen = run(body, Feed('/in', [{'data': 'a'}]), feed=feed)

        assert seen.of('not_connected') != []
        assert seen.of('input') == []

    def test_optional_feed_goes_on_without_a_listener(self, run):
        """The exam may test whether any subscription exists."""
        seen = run(LATCHED, Feed('/in', [{'data': 'a'}], optional=True), feed={'/in': STRING})

        assert seen.of('not_connected') != []
        assert seen.end_reason == 'complete'

    def test_answers_are_distinguished_by_the_input_they_follow(self, run):
        """Inputs come once a second, and each is answered at the same instant."""
        body = """
def make():
    node = Node('relay')
    publisher = node.create_publisher(String, '/out', 10)
    node.create_subscription(String, '/in', publisher.publish, 10)
    return node
"""
        words = [{'data': word} for word in 'abc']

        seen = run(body, Feed('/in', words), feed={'/in': STRING}, watch={'/out': STRING})

        heard = [(event['after_input'], event['data']) for event in seen.messages('/out')]
        assert heard == list(enumerate(words))
        times = [event['clock_ns'] for event in seen.messages('/out')]
        assert [later - times[0] for later in times] == [0, SECOND, 2 * SECOND]
        assert times == [event['clock_ns'] for event in seen.of('input')]


@pytest.mark.parametrize(
    ('steps', 'numbers'),
    [
        ([*unheard('/ticks', 2.0), Advance(2.0)], [6, 7, 8, 9]),
        (
            [Mark('begin'), Advance(1.0), *unheard('/ticks', 2.0), Advance(1.0)],
            [1, 2, 3, 8, 9],
        ),
    ],
    ids=['from the start', 'in between'],
)
def test_numbers_show_how_many_messages_had_no_subscription(run, steps, numbers):
    body = """
def make():
    node = Node('clock')
    publisher = node.create_publisher(Int32, '/ticks', 10)
    node.create_timer(0.5, lambda: publisher.publish(Int32()))
    return node
"""
    seen = run(body, *steps, watch={'/ticks': INT})

    assert [event['number'] for event in seen.messages('/ticks')] == numbers


def test_a_step_that_cannot_be_taken_is_named(run):
    """The error for an untested exam names the exam and the step."""
    body = """
def make():
    node = Node('a')
    node.create_subscription(Int32, 'numbers', print, 10)
    return node
"""
    steps = Look('here'), Feed('/numbers', [{'data': ''}])

    with pytest.raises(ProbeFailed, match=r'exam steps: .*step 2 \(feed\): AssertionError: The '):
        run(body, *steps, feed={'/numbers': INT})
