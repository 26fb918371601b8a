"""Test how long a ros2 command searches the graph before it reports a missing entity."""

import argparse
from contextlib import contextmanager
from types import SimpleNamespace

import pytest

from roslab.ros2 import discovery, graph
from roslab.ros2.graph import known_class

pytestmark = [pytest.mark.ros]
LATE_S = 1.0
TOPICS = {'/chatter': 'std_msgs/msg/String', '/late': 'std_msgs/msg/Int32'}


class Graph:
    """A node's view of a graph to which a topic is added late; its time passes only in sleep."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds

    def get_topic_names_and_types(self):
        found = [(name, [kind]) for name, kind in TOPICS.items()]
        return found if self.now >= LATE_S else found[:1]

    def get_node_names_and_namespaces(self):
        return [('_ros2cli', '/'), ('talker', '/')]

    def get_service_names_and_types(self):
        return [('/talker/reset', ['std_srvs/srv/Empty'])]

    def get_publishers_info_by_topic(self, topic):
        return [SimpleNamespace(node_name='talker')]

    def get_subscriptions_info_by_topic(self, topic):
        return []

    def count_publishers(self, topic):
        return 1

    def count_subscribers(self, topic):
        return 0

    def get_name(self):
        return '_ros2cli'

    def get_namespace(self):
        return '/'


@pytest.fixture
def looked_s(monkeypatch):
    """Provide a function that returns how long a command searches [s], given its condition."""

    def look(known=None):
        seen = Graph()
        monkeypatch.setattr(discovery, 'time', seen)
        monkeypatch.setattr(discovery, 'ros_node', contextmanager(lambda args: iter([seen])))
        with discovery.knowing_node(argparse.Namespace(spin_time=0.5), known) as node:
            assert node is seen
        return seen.now

    return look


def test_what_appears_late_is_found_when_it_appears(looked_s):
    """A quiet graph does not prove that a topic is missing; the wait ends when it appears."""
    assert LATE_S < looked_s(lambda node: graph.topic_types(node, '/late')) < LATE_S + 0.3
    assert LATE_S < looked_s(lambda node: known_class(node, 'late')) < LATE_S + 0.3


@pytest.mark.parametrize(
    ('kind', 'name', 'missing'),
    [
        (graph.topic_types, '/chatter', '/nope'),
        (graph.node_known, '/talker', '/nope'),
        (graph.service_types, '/talker/reset', '/nope'),
    ],
)
def test_only_what_is_missing_takes_the_whole_time(looked_s, kind, name, missing):
    """If the graph contains the entity, the wait ends after the quiet time, as for a list."""
    assert looked_s(lambda node: kind(node, name)) == looked_s() < 0.3
    assert looked_s(lambda node: kind(node, missing)) >= discovery.LIMIT_S
