"""Pictures and facts of live nodes, in private contexts of the test process."""

import contextlib
import queue
import re
import time

import pytest

rclpy = pytest.importorskip('rclpy')

from live_kernels import execute, kernel, kernel_to_share  # noqa: F401 - fixtures
from private_session import PrivateSession, session  # noqa: F401 - fixture
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, qos_profile_sensor_data, QoSProfile
from std_msgs.msg import Float64, String

from roslab.errors import NotHereError, RoslabError
from roslab.graph_picture import graph
from roslab.introspection import echo, hz, info, topics
from roslab.listening import Listener
from roslab.live_plot import Plot
from roslab.session import wait_in
from roslab.timeline_picture import timeline

pytestmark = pytest.mark.ros

RELIABLE = QoSProfile(depth=10)
SOON_S = 60.0  # limit for waits that take milliseconds on an idle machine
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Wave(Node):
    """Publishes 1.0, 2.0, ... at 50 Hz, and its name."""

    def __init__(self):
        super().__init__('wave', namespace='/lab')
        self.count = 0
        self.sent = []
        self.numbers = self.create_publisher(Float64, 'number', 10)
        self.names = self.create_publisher(String, '/name', qos_profile_sensor_data)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.sent.append(time.monotonic())
        self.numbers.publish(Float64(data=float(self.count)))
        self.names.publish(String(data='wave'))


class Hearing(Node):
    """Subscribes to a topic."""

    def __init__(self, kind=Float64, topic='/lab/number', qos=RELIABLE):
        super().__init__('hearing')
        self.create_subscription(kind, topic, lambda message: None, qos)


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Stop searching quickly."""
    monkeypatch.setattr('roslab.introspection.DISCOVERY_S', 0.2)
    monkeypatch.setattr('roslab.graph_picture.DISCOVERY_S', 0.2)
    monkeypatch.setattr('roslab.lookup.DISCOVERY_S', 0.2)


def seen(session, text, **options):
    """Wait until the text of the graph has a line with a text, and return all of it."""
    wait_in(lambda: text in str(graph(**options)), SOON_S)
    return str(graph(**options))


def test_live_nodes_that_fit_are_connected(session):
    """One line has the publisher, the topic with its type and the subscriber."""
    session.start(Wave)
    session.start(Hearing)

    assert (
        '/lab/wave --> /lab/number [std_msgs/msg/Float64] --> /hearing'
        in seen(session, '--> /hearing').splitlines()
    )


def test_live_nodes_whose_qos_differs_are_not_connected(session):
    session.start(Wave)
    node = session.start(lambda: Hearing(String, '/name', LATCHED))

    text = seen(session, '- -> /hearing')
    assert 'reliability: offers BEST_EFFORT, wants RELIABLE' in text
    assert 'durability: offers VOLATILE, wants TRANSIENT_LOCAL' in text
    assert node.get_name() == 'hearing'


def test_live_nodes_of_different_types_are_not_connected(session):
    """Two programs can use one name for two types, and neither hears the other."""
    session.start(Wave)
    other = PrivateSession(session.domain)
    try:
        other.start(lambda: Hearing(String))
        text = seen(session, 'type differs')
    finally:
        other.close()

    assert 'type differs: std_msgs/msg/Float64 | std_msgs/msg/String' in text
    assert '/lab/number [std_msgs/msg/Float64 | std_msgs/msg/String]' in text


def test_graph_hides_what_every_node_has_unless_all_is_asked_for(session):
    """The notebook's own node, /rosout and /parameter_events are shown only with all=True."""
    session.start(Wave)
    listener = Listener('/lab/number', Float64, RELIABLE)

    short = seen(session, 'this notebook listens')
    assert '_roslab' not in short
    assert '--> /rosout' not in short
    everything = seen(session, '--> /_roslab', all=True)
    assert '/lab/wave' in everything
    assert '/parameter_events [' in everything
    assert listener.wait(1)


def test_graph_shows_a_listener_whose_topic_nobody_publishes(session):
    """Both sides of a misspelt name are dashed, as in ``ros2 topic list``."""
    session.start(Wave)
    listener = Listener('/lab/numbr', Float64, RELIABLE)

    text = seen(session, 'nobody publishes')
    assert '/lab/wave - -> /lab/number [std_msgs/msg/Float64]   nobody subscribes' in text
    assert '/lab/numbr [std_msgs/msg/Float64] - -> /_roslab (of a notebook)' in text
    assert listener.alive


def test_graph_of_one_topic_leaves_the_others_out(session):
    """A relative name of the topic is enough."""
    session.start(Wave)

    found = graph('name')
    assert found.topics == ['/name']
    assert found.nodes == ['/lab/wave']


@pytest.mark.parametrize(
    'ask',
    [
        lambda: graph('/nam'),
        lambda: echo('/nam'),
        lambda: hz('/nam'),
        lambda: info('/nam'),
        lambda: Plot('/nam', 'data'),
    ],
)
def test_topic_that_nobody_has_is_answered_with_the_nearest_name(session, ask):
    session.start(Wave)

    with pytest.raises(NotHereError, match=r'no topic.* /nam now\. Did you mean /name\?'):
        ask()


def test_impossible_name_of_a_topic_is_refused_with_the_rule(session):
    """The error has the rule of rcl, without the place in its source."""
    with pytest.raises(RoslabError, match="'two words' cannot be the name of a topic: ") as caught:
        graph('two words')
    assert '.c:' not in str(caught.value)


def test_echo_finds_type_and_qos_and_prints_yaml(session, capsys):
    """A best-effort publisher is heard without a profile."""
    session.start(Wave)
    echo('name', 2, SOON_S)

    assert capsys.readouterr().out == 'data: wave\n---\ndata: wave\n---\n'


def test_echo_that_hears_nothing_says_why_and_leaves_no_subscription(session):
    wave = session.start(Wave)

    with pytest.raises(TimeoutError, match=r'/name, but the QoS does not match\. .*subscription$'):
        echo('/name', 1, 0.1, qos=LATCHED)
    assert wait_in(lambda: not wave.count_subscribers('/name'), SOON_S)


def test_rate_of_a_timer_is_measured(session, capsys):
    """The layout is that of ``ros2 topic hz``."""
    wave = session.start(Wave)
    hz('/lab/number', 20, SOON_S)

    out = capsys.readouterr().out
    assert re.fullmatch(
        r'average rate: [\d.]+\n\tmin: [\d.]+s max: [\d.]+s std dev: [\d.]+s window: 19\n', out
    )
    # A busy machine skips ticks, so compare with the times of the messages that were sent.
    rates = [19 / (last - first) for first, last in zip(wave.sent, wave.sent[19:])]
    assert 0.7 * min(rates) < float(out.split()[2]) < 1.3 * max(rates)


def test_info_describes_a_topic_or_a_node(session, capsys):
    """A topic has endpoints with QoS; a node has publishers and services."""
    session.start(Wave)
    info('/lab/number')
    topic = capsys.readouterr().out
    info('lab/wave')
    node = capsys.readouterr().out

    assert topic.startswith(
        'Type: std_msgs/msg/Float64\n\nPublisher count: 1\n\nNode name: wave\n'
    )
    assert '\nQoS profile:\n  Reliability: RELIABLE\n' in topic
    assert topic.endswith('\nSubscription count: 0\n')
    assert node.startswith('/lab/wave\n  Subscribers:\n')
    assert '    /lab/number: std_msgs/msg/Float64\n    /name: std_msgs/msg/String\n' in node
    assert '    /lab/wave/get_parameters: rcl_interfaces/srv/GetParameters\n' in node


def test_topics_are_listed_with_their_types(session, capsys):
    session.start(Wave)
    topics()

    assert '/lab/number [std_msgs/msg/Float64]\n/name [std_msgs/msg/String]\n' in (
        capsys.readouterr().out
    )


def test_reception_times_belong_to_their_messages(session):
    session.start(Wave)
    heard = Listener('/lab/number', Float64, RELIABLE)
    heard.wait(10)
    times, now = heard.times, heard.now
    session.stop('/lab/wave')
    heard.stop()
    wait_in(lambda: not list(session.helper.subscriptions), SOON_S)

    assert len(heard.times) == len(heard.messages)
    assert times == sorted(times)
    assert 0 <= times[0] <= times[-1] <= now
    heard.clear()
    assert heard.times == []


def test_timeline_counts_what_listeners_heard(session):
    """The times of the second listener are moved to the axis of the first."""
    session.start(Wave)
    first = Listener('/lab/number', Float64, RELIABLE)
    first.wait(5)
    second = Listener('/name', String, qos_profile_sensor_data)
    second.wait(5)
    line = timeline(first, second, marks={'second began': [second.began - first.began]})

    assert len(line.rows[1].times) >= 5
    assert line.rows[1].times[0] >= line.rows[2].times[0] > line.rows[0].times[3]


def test_plot_waits_for_values_and_shows_them(session):
    session.start(Wave)
    plot = Plot('/lab/number', 'data', threshold=3.0)
    values = plot.wait(6, SOON_S)

    assert values[:6] == [values[0] + step for step in range(6)]
    before, text, after = plot.values[-1], str(plot), plot.values[-1]
    assert before <= float(re.search(r'last (\d+(?:\.\d+)?)', text)[1]) <= after
    plot.stop()
    assert not plot.listener.alive


def test_plot_of_a_wrong_field_leaves_no_subscription(session):
    wave = session.start(Wave)

    with pytest.raises(RoslabError, match='Numeric fields: data'):
        Plot('/lab/number', 'value')
    assert wait_in(lambda: not wave.count_subscribers('/lab/number'), SOON_S)


COUNTER = """
from roslab import *
from rclpy.node import Node
from std_msgs.msg import Float64

class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        self.count = 0
        self.publisher = self.create_publisher(Float64, 'number', 10)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.publisher.publish(Float64(data=float(self.count)))

counter = start(Counter)
"""


def pictures(kernel, seconds, until=lambda found: False, kind='update_display_data'):
    """Return the messages of one kind that arrive while no cell runs, with their times."""
    found, end = [], time.monotonic() + seconds
    while time.monotonic() < end and not until(found):
        with contextlib.suppress(queue.Empty):
            message = kernel.client.get_iopub_msg(timeout=0.1)
            if message['msg_type'] == kind:
                sent_s = message['header']['date'].timestamp()
                found.append((sent_s, message['content']))
    return found


def test_plot_moves_in_its_cell_until_it_is_stopped(kernel):
    kernel.run(COUNTER, cell_id='a')
    kernel.run('curve = plot("number", "data", threshold=5.0)', cell_id='b')
    found = pictures(kernel, 20.0, until=lambda found: len(found) > 5)
    ids = {content['transient']['display_id'] for _, content in found}
    shown = found[-1][1]['data']

    assert len(ids) == 1
    assert 'above the threshold 5' in shown['text/plain']
    assert 'role="img"' in shown['text/html']
    assert found[5][0] - found[0][0] > 0.7  # five updates a second
    stopped = kernel.run('curve.stop(); print(curve.listener.alive, len(curve.values) > 5)')
    assert stopped.text == 'False True\n'
    assert pictures(kernel, 0.6) == []


def test_plot_is_redrawn_in_place_once_a_page_reports_that_it_shows_it(kernel):
    """From then on, the notebook gets the picture only at the end of a cell."""
    kernel.run(COUNTER, cell_id='a')
    shown = kernel.run(
        'curve = plot("number", "data")\nprint(curve._widget.model_id)', cell_id='b'
    )
    comm = shown.text.strip()
    said = {'comm_id': comm, 'data': {'method': 'custom', 'content': 'shown'}}
    client = kernel.client
    client.shell_channel.send(client.session.msg('comm_msg', said))
    found = pictures(kernel, 60.0, lambda found: len(found) > 5, 'comm_msg')
    states = [content['data'].get('state', {}) for _, content in found]
    in_pages = pictures(kernel, 0.6)
    (saved,) = kernel.run('pass').data

    assert re.search('data-picture="[0-9a-f]{32}"><div role="group"', saved['text/html'])
    assert {content['comm_id'] for _, content in found} == {comm}
    assert len({state['picture'] for state in states if 'picture' in state}) > 3
    assert in_pages == []
    assert kernel.run('curve.stop()').error is None


def test_plot_of_the_same_field_replaces_the_older_one(kernel):
    kernel.run(COUNTER, cell_id='a')
    for _ in range(3):
        assert kernel.run('curve = plot("number", "data")', cell_id='b').error is None
    out = kernel.run(
        'import threading\n'
        'names = lambda: [t.name for t in threading.enumerate()].count("roslab picture")\n'
        'wait_until(lambda: counter.count_subscribers("number") == names() == 1, 60)\n'
        'print(names())'
    )

    assert out.error is None
    assert out.text == '1\n'


def test_plot_goes_on_after_stop_all(kernel):
    kernel.run(COUNTER, cell_id='a')
    kernel.run('curve = plot("number", "data"); curve.wait(3); stop_all()', cell_id='b')
    out = kernel.run(
        'start(Counter); n = len(curve.values)\nprint(len(curve.wait(n + 3)) > n)', cell_id='c'
    )

    assert out.error is None
    assert out.text.endswith('True\n')


def test_executed_notebook_keeps_the_last_picture_of_a_plot(tmp_path):
    """Without a frontend, the cell keeps the picture from the end of the wait."""
    notebook = execute(
        [COUNTER, 'curve = plot("number", "data")', 'curve.wait(30); curve.stop()'], tmp_path
    )
    outputs = [cell.outputs for cell in notebook.cells]

    (shown,) = outputs[1]
    count = int(re.search(r'(\d+) values', shown.data['text/plain'])[1])
    assert count >= 30
    assert '<polyline' in shown.data['text/html']
    assert outputs[2] == []
