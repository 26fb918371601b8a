"""Nodes that run in the background, in private contexts of the test process."""

from io import StringIO
import sys
import threading
import time

import pytest

rclpy = pytest.importorskip('rclpy')

from private_session import session  # noqa: F401 - fixture
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data, QoSProfile
from std_msgs.msg import Int32, String

from roslab.console import ConsoleLines, MARK
from roslab.errors import NotHereError, RoslabError
from roslab.executor import BackgroundExecutor, CallbackStopped
from roslab.listening import Listener
from roslab.logtable import logs
from roslab.session import HELPER_NAME, wait_until

pytestmark = pytest.mark.ros

RELIABLE = QoSProfile(depth=10)
SOON_S = 60  # limit for waits that take milliseconds on an idle machine


class Talker(Node):
    """Logs and publishes numbers quickly."""

    def __init__(self, name='talker', topic='chatter', qos=RELIABLE):
        super().__init__(name)
        self.declare_parameter('prefix', '')
        self.count = 0
        self.publisher = self.create_publisher(String, topic, qos)
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.count += 1
        text = f'{self.get_parameter("prefix").value}{self.count}'
        self.publisher.publish(String(data=text))
        self.get_logger().info(f'said {text}', once=True)


class Failing(Talker):
    """Raises in its third callback."""

    def __init__(self, error=ZeroDivisionError):
        super().__init__('failing', 'failures')
        self.error = error

    def on_timer(self):
        super().on_timer()
        if self.count == 3:
            raise self.error('third')


class Endless(Node):
    """Has a callback that never returns."""

    def __init__(self):
        super().__init__('endless')
        self.entered = threading.Event()
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.entered.set()
        while True:
            pass


@pytest.mark.claim('J1')
def test_started_node_publishes_while_the_test_waits(session):
    session.start(Talker)
    heard = Listener('chatter', String, RELIABLE)

    said = [int(message.data) for message in heard.wait(3)][:3]
    assert said == [said[0], said[0] + 1, said[0] + 2]
    assert heard.last in heard.messages


def test_node_started_again_replaces_the_older_one_without_a_warning(session, capfd):
    """Running a cell twice leaves one node, and the middleware prints no warning."""
    first = session.start(Talker)
    second = session.start(Talker)
    names = second.get_node_names()

    assert names.count('talker') == 1
    assert session.nodes() == {'talker': second}
    assert first is not second
    out, err = capfd.readouterr()
    assert 'already registered' not in out + err
    assert err == ''


def test_running_node_keeps_its_class_until_it_is_started_again(session):
    classes = [type('Greeter', (Node,), {'word': word}) for word in ('hello', 'bye')]
    old, new = (session.start(lambda made=made: made('greeter')) for made in classes)

    assert (old.word, new.word) == ('hello', 'bye')
    assert session.nodes() == {'greeter': new}


@pytest.mark.parametrize(
    ('rules', 'full'),
    [
        ('-r __node:=eve -r __ns:=/south', '/south/eve'),
        ('--remap adam:__node:=eve', '/eve'),
        ('-r other:__node:=bob -r __name:=eve -r __node:=cain', '/eve'),
        ('-r chatter:=news -p prefix:=a', '/adam'),
    ],
)
def test_node_that_is_renamed_by_its_arguments_replaces_the_older_one_without_a_warning(
    session, capfd, rules, full
):
    """Nodes are compared by their names after remapping."""

    def adam():
        return Node('adam', cli_args=['--ros-args', *rules.split()])

    session.start(adam)
    again = session.start(adam)

    assert again.get_fully_qualified_name() == full
    assert list(session.nodes().values()) == [again]
    assert 'already registered' not in ''.join(capfd.readouterr())


def test_name_and_parameters_are_passed_to_a_class_that_takes_no_arguments(session):
    """`start(Talker, name=..., parameters=...)` acts as remapping and -p do in a terminal."""
    node = session.start(Talker, name='other', parameters={'prefix': 'no. '})
    heard = Listener('chatter', String, RELIABLE)

    assert node.get_name() == 'other'
    assert heard.wait(1)[0].data.startswith('no. ')


def test_plain_node_takes_its_name_from_start(session):
    """`start(Node, name=...)` works without a subclass."""
    assert session.start(Node, name='bench').get_name() == 'bench'


def test_two_nodes_of_one_class_run_under_two_names(session):
    session.start(Talker, name='one')
    session.start(lambda: Talker('two'))

    assert sorted(session.nodes()) == ['one', 'two']


def test_same_name_in_another_namespace_is_another_node(session):
    """A node's name includes its namespace."""
    session.start(lambda: Node('talker', namespace='lab'))
    session.start(Talker)

    assert sorted(session.nodes()) == ['/lab/talker', 'talker']
    session.stop('/lab/talker')
    assert sorted(session.nodes()) == ['talker']


def test_failing_callback_ends_its_node_and_no_other(session, capfd):
    """The message names the node and the line, and other nodes continue; stderr stays empty."""
    talker = session.start(Talker)
    failing = session.start(Failing)
    wait_until(lambda: 'failing' not in session.nodes(), SOON_S, 'the failure')
    count = talker.count
    wait_until(lambda: talker.count > count + 5, SOON_S, 'the talker')

    out, err = capfd.readouterr()
    assert 'failing stopped' in out
    assert "raise self.error('third')" in out
    assert 'ZeroDivisionError: third' in out
    assert 'rclpy' not in out
    assert err == ''
    assert 'failing' not in talker.get_node_names()
    assert failing.count == 3


def test_node_that_fails_before_start_returns_is_named(session, capfd, monkeypatch):
    """The first callback may run before the cell's own thread continues."""
    add = BackgroundExecutor.add

    def add_slowly(executor, node):
        add(executor, node)
        wait_until(lambda: 'failing' not in session.nodes(), SOON_S, 'the failure')

    monkeypatch.setattr(BackgroundExecutor, 'add', add_slowly)
    session.start(Failing)

    assert 'failing stopped because a callback raised an exception' in capfd.readouterr().out
    assert session.losses() == 'Node failing stopped: ZeroDivisionError: third.'


def test_request_that_is_hit_by_the_end_of_a_callback_is_carried_out(session):
    """The exception that ends a callback may arrive just after the callback has returned."""
    began = []

    def request():
        began.append(1)
        if len(began) == 1:
            raise CallbackStopped

    assert session.executor._do(request, SOON_S)

    assert len(began) == 2


def test_why_a_node_stopped_is_said_before_it_is_gone(session, monkeypatch):
    """A cell that waits until the node is gone finds the reason on the page."""
    seen = []

    class Page(StringIO):
        def write(self, text):
            seen.append((text, 'failing' in session.nodes(), session.losses()))
            return len(text)

    monkeypatch.setattr(sys, 'stdout', Page())
    session.start(Failing)
    wait_until(lambda: 'failing' not in session.nodes(), SOON_S, 'the failure')

    text, running, losses = seen[0]
    assert 'failing stopped' in text
    assert running
    assert 'third' in losses


def test_failed_node_can_be_started_again(session):
    session.start(Failing)
    wait_until(lambda: 'failing' not in session.nodes(), SOON_S, 'the failure')
    node = session.start(lambda: Talker('failing'))
    wait_until(lambda: node.count > 3, SOON_S, 'the new node')

    assert session.hints() == ''


@pytest.mark.parametrize('error', [SystemExit, KeyboardInterrupt])
def test_exit_in_a_callback_ends_its_node_only(session, error):
    """sys.exit() in a callback ends neither the kernel nor the executor."""
    talker = session.start(Talker)
    session.start(lambda: Failing(error))
    wait_until(lambda: 'failing' not in session.nodes(), SOON_S, 'the failure')
    count = talker.count

    assert wait_until(lambda: talker.count > count, SOON_S, 'the talker')


def test_endless_callback_is_named_and_ended_by_stop(session):
    """A failed wait names a callback in an endless loop, and stop() frees the thread."""
    talker = session.start(Talker)
    endless = session.start(Endless)
    assert endless.entered.wait(SOON_S)
    with pytest.raises(TimeoutError, match=r"stop\('endless'\)"):
        wait_until(lambda: False, 1.2, 'what cannot be')
    begin = time.monotonic()
    session.stop(endless)

    assert time.monotonic() - begin < 60
    count = talker.count
    assert wait_until(lambda: talker.count > count, SOON_S, 'the talker')


@pytest.mark.parametrize('which', ['talker', 'other'])
def test_a_node_stopped_in_a_callback_leaves_the_graph(session, which):
    session.start(Talker)
    other = session.start(Talker, name='other')
    other.create_timer(0.01, lambda: session.stop(which))

    wait_until(lambda: which not in session.nodes(), SOON_S, 'the stop')

    seen = session.helper.get_node_names
    assert wait_until(lambda: which not in seen(), SOON_S, 'the graph')


def test_stop_destroys_the_node_of_a_slow_thread(session, monkeypatch):
    """On a busy machine, the thread may respond only to a second request."""
    session.start(Talker)
    other = session.start(Talker, name='other')
    really, slow = BackgroundExecutor._do, [True]
    monkeypatch.setattr(
        BackgroundExecutor,
        '_do',
        lambda self, action, patience_s: (
            not slow.pop() if slow else really(self, action, patience_s)
        ),
    )

    session.stop('talker')

    assert not slow
    assert 'talker' not in other.get_node_names()


def test_close_ends_even_an_endless_callback(session):
    endless = session.start(Endless)
    assert endless.entered.wait(SOON_S)
    threads = [t for t in threading.enumerate() if t.name == 'roslab executor']
    begin = time.monotonic()
    session.close()

    assert time.monotonic() - begin < 60
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()


def test_node_whose_constructor_fails_leaves_nothing_in_the_graph(session):
    """An incomplete node would stay visible as long as the notebook keeps the traceback."""

    def half():
        Node('half')
        raise ValueError('not now')

    talker = session.start(Talker)
    with pytest.raises(ValueError, match='not now') as kept:
        session.start(half)

    assert kept.traceback
    assert sorted(talker.get_node_names()) == ['talker']


def test_constructor_that_is_interrupted_in_rclpy_leaves_nothing_in_the_graph(session):
    """A frame refers to a new publisher, and so to its node, before rclpy stores the publisher."""

    class Half(Node):
        def __init__(self):
            super().__init__('half')
            qos = QoSProfile(depth=10).get_c_qos_profile()
            with self.handle:
                publisher = _rclpy.Publisher(self.handle, String, 'chatter', qos)
            raise KeyboardInterrupt(publisher.get_topic_name())

    other = session.start(Talker)
    with pytest.raises(KeyboardInterrupt) as caught:
        session.start(Half)

    assert caught.tb is not None  # as IPython keeps it
    assert 'half' not in other.get_node_names()


@pytest.mark.parametrize(
    ('factory', 'word'),
    [(lambda: None, 'NoneType'), (String, 'String'), (3, 'node class'), ('x', 'node class')],
)
def test_start_of_something_else_says_what_it_expected(session, factory, word):
    with pytest.raises(RoslabError, match=word):
        session.start(factory)


def test_start_of_main_is_refused(session):
    """main() spins forever, so the cell would never end."""

    def main():
        raise AssertionError('was called')

    with pytest.raises(RoslabError, match='main'):
        session.start(main)


def test_stop_is_repeatable_and_names_a_wrong_name(session):
    """Stopping a node twice is allowed; an unknown name is an error."""
    node = session.start(Talker)
    session.stop(node)
    session.stop(node)
    session.stop('talker')

    with pytest.raises(NotHereError, match='walker'):
        session.stop('walker')


@pytest.mark.parametrize('name', ['/lab/talker', 'lab/talker'])
def test_stop_takes_a_name_with_its_namespace(session, name):
    session.start(lambda: Node('talker', namespace='/lab', context=session.executor.context))
    session.stop(name)

    assert session.nodes() == {}


def test_session_starts_anew_after_a_shutdown(session):
    """If a cell shuts ROS down, the nodes end but the kernel remains usable."""
    session.start(Talker)
    session.executor.context.shutdown()

    assert session.nodes() == {}
    node = session.start(Talker)
    assert wait_until(lambda: node.count > 2, SOON_S, 'the talker')


def test_node_destroyed_by_a_cell_is_no_longer_listed(session):
    talker = session.start(Talker)
    other = session.start(Talker, name='other')
    other.destroy_node()

    assert list(session.nodes()) == ['talker']
    count = talker.count
    assert wait_until(lambda: talker.count > count + 5, SOON_S, 'the talker')


def test_wait_returns_the_value_and_is_woken_by_callbacks(session):
    talker = session.start(Talker)

    said = wait_until(lambda: talker.count >= 3 and 'three', SOON_S, 'three')
    assert said == 'three'


def test_wait_from_a_callback_is_refused(session, capfd):
    """A callback that waits for other callbacks would wait forever."""

    class Waiting(Node):
        def __init__(self):
            super().__init__('waiting')
            self.create_timer(0.01, lambda: wait_until(lambda: False, SOON_S, 'it'))

    session.start(Waiting)
    wait_until(lambda: 'waiting' not in session.nodes(), SOON_S, 'the failure')

    assert 'A callback cannot wait' in capfd.readouterr().out


@pytest.mark.claim('J10')
@pytest.mark.parametrize('timeout', [float('inf'), -1, None, 'soon'])
def test_wait_without_a_bound_is_refused(session, timeout):
    with pytest.raises(RoslabError, match='seconds'):
        wait_until(lambda: True, timeout, 'it')


def test_silence_is_explained_by_a_similar_topic(session):
    session.start(Talker)
    with pytest.raises(TimeoutError, match='did you mean /chatter'):
        Listener('chater', String, RELIABLE).wait(1, timeout=0.2)


def test_silence_is_explained_by_incompatible_qos(session):
    session.start(lambda: Talker(qos=qos_profile_sensor_data))
    with pytest.raises(TimeoutError, match='QoS'):
        Listener('chatter', String, RELIABLE).wait(1, timeout=0.2)


def test_another_type_on_the_topic_is_named(session, capfd):
    """The error names the topic's type, and nothing is written to stderr."""
    talker = session.start(Talker)
    wait_until(lambda: talker.count > 0, SOON_S, 'the talker')
    with pytest.raises(RoslabError, match='std_msgs/msg/String'):
        Listener('chatter', Int32, RELIABLE)
    assert capfd.readouterr().err == ''


def test_topic_and_type_in_the_other_order_are_reported(session):
    """The error has a correct example that can be copied."""
    with pytest.raises(RoslabError, match=r"as in listen\('chatter', String\)"):
        Listener(String, 'chatter', RELIABLE)


def test_listener_of_a_failed_wait_goes_although_its_traceback_stays(session):
    """A kernel keeps the last traceback; the subscription must not stay alive with it."""
    listener = Listener('chatter', String, RELIABLE)
    with pytest.raises(TimeoutError) as kept:
        listener.wait(1, timeout=0.05)
    del listener

    assert kept.tb is not None
    assert wait_until(lambda: not list(session.helper.subscriptions), SOON_S, 'its end')


def test_failed_wait_names_the_exception_that_stopped_the_publisher(session):
    """The publisher has stopped, and the error gives the reason."""
    session.start(Failing)
    wait_until(lambda: not session.nodes(), SOON_S, 'the failure')
    with pytest.raises(TimeoutError, match='Node failing stopped: ZeroDivisionError: third'):
        Listener('failures', String, RELIABLE).wait(1, timeout=0.05)


def test_listener_without_a_name_hears_no_more(session):
    """Running a cell again must not leave the older subscription behind."""
    session.start(Talker)
    first = Listener('chatter', String, RELIABLE)
    first.wait(1)
    first = Listener('chatter', String, RELIABLE)

    assert wait_until(lambda: len(list(session.helper.subscriptions)) == 1, 5, 'the older to go')
    assert first.wait(1)


def test_stopped_listener_keeps_what_it_heard(session):
    """stop() ends the subscription and keeps the messages."""
    session.start(Talker)
    heard = Listener('chatter', String, RELIABLE)
    heard.wait(2)
    heard.stop()
    wait_until(lambda: not list(session.helper.subscriptions), SOON_S, 'the end')

    assert len(heard) >= 2
    assert 'stopped' in repr(heard)


def test_logs_are_kept_by_node(session):
    node = session.start(Talker, name='logging_talker')
    wait_until(lambda: node.count > 1, SOON_S, 'the talker')
    lines = logs('logging_talker')

    assert lines.messages == ['said 1']
    assert lines[0].level == 'INFO'
    assert 'said 1' in repr(lines)
    assert '>INFO</td>' in lines._repr_html_()


def test_helper_is_hidden_and_alone(session):
    """The notebook itself adds a single node with a hidden name to the graph."""
    talker = session.start(Talker)
    Listener('chatter', String, RELIABLE)

    assert sorted(talker.get_node_names()) == [HELPER_NAME, 'talker']


def test_mark_in_the_console_is_counted_and_not_shown():
    """The mark may arrive in pieces, and in the middle of an unfinished line."""
    console = ConsoleLines()
    mark = MARK.decode()

    shown = [console.feed(piece) for piece in ('half ', mark[:2], mark[2:], 'a line\n')]

    assert ''.join(shown) == 'half a line\n'
    assert console.marks == 1
