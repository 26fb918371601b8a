"""Managed nodes in a notebook: the picture of their state, and their end."""

import re

import pytest

rclpy = pytest.importorskip('rclpy')

from private_session import PrivateSession, session  # noqa: F401 - fixture
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node

from roslab import lifecycle_picture
from roslab.errors import NotHereError, RoslabError
from roslab.lifecycle_picture import lifecycle, LifecyclePicture
from roslab.session import wait_until

pytestmark = pytest.mark.ros


def test_picture_follows_the_node(session):
    node = session.start(lambda: LifecycleNode('valve'))
    before = lifecycle(node)
    node.trigger_configure()

    assert str(before).splitlines()[0] == '/valve is unconfigured'
    assert str(lifecycle(node)).splitlines() == [
        '/valve is inactive',
        'unconfigured   [inactive]   active   finalized',
        'next: cleanup to unconfigured, activate to active, shutdown to finalized',
    ]


def test_name_is_as_good_as_the_node(session):
    """A node of this kernel is found by its name, with or without the slash."""
    node = session.start(lambda: LifecycleNode('valve'))
    node.trigger_configure()

    assert lifecycle('valve').state == lifecycle('/valve').state == 'inactive'


def test_node_elsewhere_is_asked_over_its_service(session):
    """The service get_state gives the state of a node in another process."""
    elsewhere = PrivateSession(session.domain)
    try:
        elsewhere.start(lambda: LifecycleNode('far')).trigger_configure()

        assert str(lifecycle('far')).startswith('/far is inactive')
    finally:
        elsewhere.close()


def test_ordinary_node_is_refused_with_what_to_do(session):
    """An ordinary node has no states, and the message names the class that has them."""
    with pytest.raises(
        RoslabError, match=r'expected a LifecycleNode, got a Node.*rclpy\.lifecycle'
    ):
        lifecycle(session.start(Node, name='plain'))


def test_unknown_name_is_refused(session, monkeypatch):
    monkeypatch.setattr(lifecycle_picture, '_PATIENCE_S', 0.2)

    with pytest.raises(NotHereError, match=r"lifecycle\('/nobody'\) found no lifecycle node"):
        lifecycle('nobody')


def test_stopped_node_leaves_the_graph_though_a_name_refers_to_it(session):
    """Plain rclpy keeps the name of a lifecycle node until the object is gone."""
    node = session.start(lambda: LifecycleNode('valve'))
    other = session.start(Node, name='other')
    wait_until(lambda: 'valve' in other.get_node_names(), 5.0, 'the valve')

    session.stop(node)

    wait_until(lambda: 'valve' not in other.get_node_names(), 5.0, 'its end')
    with pytest.raises(NotHereError, match='was stopped'):
        lifecycle(node)


@pytest.mark.parametrize('state', [*lifecycle_picture.STATES, 'configuring'])
def test_drawing_shows_the_state_without_colour_and_in_words(state):
    """The current box has a thick border and the word now; the description names the state."""
    drawn = LifecyclePicture('/a<b', state)._repr_html_()

    primary = state in lifecycle_picture.STATES
    assert re.findall(r'>(\w+)</text><text[^>]*>now<', drawn) == ([state] if primary else [])
    assert drawn.count('stroke-width="3"') == primary
    assert f'">/a&lt;b is {state} ' in drawn
    assert ('configuring, still in a transition state<' in drawn) is not primary
    assert '/a<b' not in drawn


@pytest.mark.parametrize(('state', 'ways'), lifecycle_picture.WAYS.items())
def test_arrows_that_lead_on_are_solid(state, ways):
    """Arrows from other states are dashed."""
    drawn = LifecyclePicture('/a', state)._repr_html_()

    assert drawn.count('<path') - drawn.count('stroke-dasharray') == len(ways)
