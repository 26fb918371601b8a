"""Test claims about managed nodes with the real LifecycleNode."""

from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState
import pytest
from rclpy._rclpy_pybind11 import RCLError
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from std_msgs.msg import Int32

claim = pytest.mark.claim
pytestmark = pytest.mark.ros


class Managed(LifecycleNode):
    """A managed node with a publisher; the test chooses the results of its transitions."""

    answer = TransitionCallbackReturn.SUCCESS
    supers = True
    error: Exception | None = None

    def on_configure(self, state):
        self.out = self.create_lifecycle_publisher(Int32, 'numbers', 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        """Activate the publisher, unless the test omits that."""
        if self.error:
            raise self.error
        if self.supers:
            super().on_activate(state)
        return self.answer


def state_of(node) -> str:
    return node._state_machine.current_state[1]


@claim('L1')
def test_way_through_the_primary_states(world):
    node, seen = world.node(cls=Managed), []
    for trigger in ('configure', 'activate', 'deactivate', 'cleanup', 'shutdown'):
        seen.append(state_of(node))
        getattr(node, f'trigger_{trigger}')()

    assert seen == ['unconfigured', 'inactive', 'active', 'inactive', 'unconfigured']
    assert state_of(node) == 'finalized'
    primary = {name for name in dir(State) if name.startswith('PRIMARY') and 'UNKNOWN' not in name}
    transition = {name for name in dir(State) if name.startswith('TRANSITION')}
    assert (len(primary), len(transition)) == (4, 6)


@claim('L2', 'C6')
def test_plain_node_has_no_managed_states():
    assert not hasattr(Node, 'trigger_configure')
    assert hasattr(LifecycleNode, 'trigger_configure')


@claim('L3', 'L4')
def test_inactive_publisher_drops_in_silence(world):
    node, heard = world.node(cls=Managed), []
    node.trigger_configure()
    node.create_subscription(Int32, 'numbers', lambda m: heard.append(m.data), 10)
    node.out.publish(Int32(data=1))
    node.trigger_activate()
    node.out.publish(Int32(data=2))
    world.spin_until(lambda: heard, what='a number')

    assert heard == [2]


@claim('L3')
def test_without_super_the_publisher_stays_off(world):
    node = world.node(cls=Managed)
    node.supers = False
    node.trigger_configure()
    node.trigger_activate()

    assert state_of(node) == 'active'
    assert not node.out.is_activated


@claim('L4')
def test_only_deactivate_switches_a_publisher_off(world):
    """Neither a shutdown from active nor an error after activation deactivates the publisher."""
    ended, failed = (world.node(name, Managed) for name in ('ended', 'failed'))
    failed.answer = TransitionCallbackReturn.ERROR
    for node in (ended, failed):
        node.trigger_configure()
        node.trigger_activate()
    ended.trigger_shutdown()

    assert [state_of(node) for node in (ended, failed)] == ['finalized', 'unconfigured']
    assert [node.out.is_activated for node in (ended, failed)] == [True, True]


@claim('L4')
def test_timers_go_on_while_inactive(world):
    node, ticks = world.node(cls=Managed), []
    node.trigger_configure()
    node.create_timer(0.01, lambda: ticks.append(1))

    world.spin_until(lambda: ticks, what='a tick')
    assert state_of(node) == 'inactive'


@claim('L5')
def test_failure_returns_and_error_is_processed(world, capfd):
    """FAILURE leads back to inactive; ERROR and exceptions lead silently to a different state."""
    node = world.node('fails', Managed)
    node.answer = TransitionCallbackReturn.FAILURE
    node.trigger_configure()
    node.trigger_activate()
    assert state_of(node) == 'inactive'

    for name, answer, error in (
        ('errs', TransitionCallbackReturn.ERROR, None),
        ('raises', TransitionCallbackReturn.SUCCESS, RuntimeError('the reason')),
    ):
        node = world.node(name, Managed)
        node.answer, node.error = answer, error
        node.trigger_configure()
        node.trigger_activate()
        assert state_of(node) in ('unconfigured', 'finalized')
    captured = capfd.readouterr()
    assert 'the reason' not in captured.out + captured.err


@claim('L6')
def test_transition_that_does_not_exist_here_raises(world):
    """An unconfigured node cannot be activated."""
    with pytest.raises(RCLError):
        world.node(cls=Managed).trigger_activate()


@claim('L6')
def test_transition_asked_for_by_label_is_refused_in_the_answer(world):
    """The same request by number raises an exception in the node."""
    world.node('managed', Managed)
    client = world.node('boss').create_client(ChangeState, 'managed/change_state')
    world.spin_until(client.service_is_ready, what='the service')
    answer = client.call_async(ChangeState.Request(transition=Transition(label='activate')))
    world.spin_until(answer.done, what='the answer')
    assert not answer.result().success

    number = Transition.TRANSITION_ACTIVATE
    answer = client.call_async(ChangeState.Request(transition=Transition(id=number)))
    with pytest.raises(RCLError):
        world.spin_until(answer.done, what='the answer')


@claim('L7')
def test_transitions_are_announced_and_services_are_there(world):
    node, events = world.node('managed', Managed), []
    node.create_subscription(TransitionEvent, 'managed/transition_event', events.append, 10)
    node.trigger_configure()
    world.spin_until(lambda: len(events) >= 2, what='the transition')
    services = dict(node.get_service_names_and_types_by_node('managed', '/'))

    assert events[-1].goal_state.label == 'inactive'
    assert {'/managed/get_state', '/managed/change_state'} <= set(services)


@claim('L8')
def test_subscriptions_of_an_inactive_node_hear(world):
    node, heard = world.node(cls=Managed), []
    node.create_subscription(Int32, 'orders', heard.append, 10)
    world.node('boss').create_publisher(Int32, 'orders', 10).publish(Int32(data=1))

    world.spin_until(lambda: heard, what='the order')
    assert state_of(node) == 'unconfigured'
