"""Test recordings in MCAP files: their contents, programs that read them, and their replay."""

from contextlib import ExitStack
import json
import math
from pathlib import Path
import shutil
import signal
import subprocess
import sys
import threading

import pytest

rclpy = pytest.importorskip('rclpy')

from mcap.reader import make_reader
from mcap.writer import Writer
from private_session import PrivateSession
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Int32, String
from test_ros2_command import bare_shell
import yaml

from autograder.simulated import LogRecord, Simulation, TopicRecord
from environment.ros import ros_environment
from environment.ros2_command import overlaid
from roslab.bags import player, writer
from roslab.bags.bag import plain_profiles, profile_to_offer
from roslab.bags.reader import BagError, messages_of, open_bag
from roslab.cli_text import message_dict
from roslab.errors import RoslabError
from roslab.listening import Listener
from roslab.recording import record, replay
from roslab.ros2.interface import interface_class, interfaces_of
from tests.own_domain import own_domain

pytestmark = pytest.mark.ros

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LIMIT_S = 60.0
KEPT = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
PACKAGES = (
    'builtin_interfaces',
    'geometry_msgs',
    'lifecycle_msgs',
    'nav_msgs',
    'rcl_interfaces',
    'sensor_msgs',
    'std_msgs',
    'temp_monitor_pkg',
)
TYPES = [f'{package}/{name}' for package in PACKAGES for name in interfaces_of(package, ['msg'])]


def filled(kind):
    """Return a message without default values: lists have two items."""
    message = kind()
    for name, described in kind.get_fields_and_field_types().items():
        old = getattr(message, name)
        if described.startswith('sequence<'):
            item, _, most = described[9:].rstrip('>').partition(', ')
            setattr(message, name, [_single(item, None)] * min(2, int(most or 2)))
        elif described.endswith(']'):
            item = described.partition('[')[0]
            setattr(message, name, [_single(item, None)] * len(old))
        else:
            setattr(message, name, _single(described, old))
    return message


def _single(described, old):
    if '/' in described:
        return filled(interface_class(described))
    if 'string' in described:
        return 'süß'
    if described == 'boolean':
        return True
    if described == 'octet':
        return b'\x07'
    return 0.5 if described in ('float', 'double') else 7


def plain(value):
    """Return fields with the types of JSON."""
    if isinstance(value, dict):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, list):
        return [plain(one) for one in value]
    return ord(value) if value in ('\x00', '\x07') else value


@pytest.fixture(scope='module')
def everything(tmp_path_factory):
    """Return a file with two messages of every type of the course, and these messages."""
    file, sent = tmp_path_factory.mktemp('bag') / 'everything.mcap', {}
    with writer.BagWriter(file) as bag:
        for number, name in enumerate(TYPES):
            kind, topic = interface_class(name), f'/topic_{number}'
            sent[topic] = [kind(), filled(kind)]
            bag.add_topic(topic, name)
            for message in sent[topic]:
                bag.write(topic, serialize_message(message), 10, 5)
    return file, sent


def test_python_reads_every_message_type_of_the_course(everything):
    """The mcap package returns the bytes, the names of the types and the profile."""
    file, sent = everything
    read = {}
    with file.open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == 'ros2'
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ('ros2msg', 'cdr')
            kind = interface_class(schema.name)
            read.setdefault(channel.topic, []).append(deserialize_message(message.data, kind))

    assert len(TYPES) > 100
    assert read == sent


@pytest.mark.skipif(not shutil.which('npm'), reason='needs npm: apt-get install npm')
def test_foxglove_reads_every_message_type_of_the_course(everything, tmp_path):
    """Foxglove's decoders need only the file, because its definitions are complete."""
    file, sent = everything
    shutil.copytree(HERE / 'foxglove', tmp_path, dirs_exist_ok=True)
    install = ['npm', 'ci', '--no-audit', '--no-fund', '--prefer-offline']
    subprocess.run(install, cwd=tmp_path, check=True, capture_output=True, timeout=LIMIT_S * 5)
    done = subprocess.run(
        ['node', 'read_recording.mjs', str(file)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
    )
    assert done.returncode == 0, done.stderr
    read = json.loads(done.stdout)

    assert read['profile'] == 'ros2'
    expected = {
        topic: [plain(message_dict(one)) for one in messages] for topic, messages in sent.items()
    }
    assert set(read['messages']) == set(expected)
    for topic, messages in expected.items():
        assert read['messages'][topic] == messages, topic


@pytest.fixture
def domain():
    """Return a domain that no other test uses."""
    with ExitStack() as until:
        yield own_domain(until)


@pytest.fixture
def session(domain, monkeypatch):
    made = PrivateSession(domain)
    monkeypatch.setattr('roslab.session._session', made)
    yield made
    made.close()


def talk(session, qos=KEPT, period_s=0.02, then=lambda count: None):
    """Start a node that publishes numbers as strings while a subscription exists."""

    class Talker(Node):
        def __init__(self):
            super().__init__('talker')
            self.count = 0
            self.publisher_ = self.create_publisher(String, 'chatter', qos)
            self.create_timer(period_s, self.on_timer)

        def on_timer(self):
            if self.publisher_.get_subscription_count():
                self.count += 1
                self.publisher_.publish(String(data=str(self.count)))
                then(self.count)

    return session.start(Talker)


def texts_of(file):
    return [deserialize_message(one.data, String).data for one in messages_of(open_bag(file))]


@pytest.mark.claim('T16')
def test_record_and_replay_keep_messages_and_qos(session, tmp_path):
    """A listener receives what was recorded, from a publisher with the same QoS."""
    talk(session)
    file = tmp_path / 'run.mcap'
    bag = record(file, 'chatter', seconds=1.0)
    session.stop('talker')
    assert [topic.name for topic in bag.topics] == ['/chatter']
    assert bag == open_bag(file)

    heard = Listener('chatter', String, QoSProfile(depth=1000))
    seen = []
    heard_first = session.helper.create_subscription(
        String,
        'chatter',
        lambda _: seen.extend(session.helper.get_publishers_info_by_topic('/chatter')),
        10,
    )
    replay(file)
    assert [one.data for one in heard.wait(bag.count, LIMIT_S)] == texts_of(file)
    assert seen[0].node_name == 'rosbag2_player'
    assert seen[0].qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert seen[0].qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert session.nodes() == {}
    session.helper.destroy_subscription(heard_first)


def test_all_topics_are_recorded_when_none_is_named(session, tmp_path):
    """Topics that appear later and the log are recorded too."""
    talk(session, then=lambda count: count == 3 and session.start(lambda: late(session)))

    def late(session):
        node = Node('late')
        node.create_publisher(Int32, 'number', KEPT).publish(Int32(data=7))
        return node

    bag = record(tmp_path / 'run.mcap', seconds=2.0)
    counts = {topic.name: topic.count for topic in bag.topics}

    assert counts['/number'] == 1
    assert counts['/chatter'] > 3
    assert '/rosout' in counts


@pytest.mark.claim('T16')
def test_replay_publishes_when_it_is_due(session, tmp_path, monkeypatch):
    """At twice the speed, half the recorded time passes before each message."""
    file, now, published = tmp_path / 'run.mcap', [100.0], []
    with writer.BagWriter(file) as bag:
        bag.add_topic('/chatter', 'std_msgs/msg/String')
        for second in (3.0, 3.5, 7.0):
            data = serialize_message(String(data=str(second)))
            bag.write('/chatter', data, int(second * 1e9), int(second * 1e9))
    node = session.start(Node, 'player')
    made = player.Player(node, open_bag(file))
    monkeypatch.setattr(player.time, 'monotonic', lambda: now[0])
    monkeypatch.setattr(
        made._publishers['/chatter'], 'publish', lambda _: published.append(now[0] - 100.0)
    )

    def wait(seconds):
        now[0] += seconds

    assert made.play(2.0, wait) == 3
    assert published == pytest.approx([0.0, 0.25, 2.0])


def test_interrupted_recording_is_complete(session, tmp_path):
    """Messages that arrived before the interrupt can be read, and nothing else is left."""
    main = threading.main_thread().ident

    def interrupt(count):
        if count == 20:
            signal.pthread_kill(main, signal.SIGINT)

    talk(session, then=interrupt)
    with pytest.raises(KeyboardInterrupt):
        record(tmp_path / 'run.mcap', 'chatter', seconds=LIMIT_S)

    session.stop_all()
    assert texts_of(tmp_path / 'run.mcap')[:3] == ['1', '2', '3']
    assert [one.name for one in tmp_path.iterdir()] == ['run.mcap']


def test_interrupted_replay_leaves_no_node(session, everything, tmp_path):
    """The interrupt arrives while the player waits for an hour."""
    file, main = tmp_path / 'run.mcap', threading.main_thread().ident
    with writer.BagWriter(file) as bag:
        bag.add_topic('/chatter', 'std_msgs/msg/String')
        for second in (0, 3600):
            bag.write('/chatter', serialize_message(String()), second * 10**9, 0)
    heard = session.helper.create_subscription(
        String, 'chatter', lambda _: signal.pthread_kill(main, signal.SIGINT), 10
    )
    with pytest.raises(KeyboardInterrupt):
        replay(file)

    assert session.nodes() == {}
    session.helper.destroy_subscription(heard)


def test_nothing_heard_writes_no_file(session, tmp_path):
    """An older file of that name is still there, and the error names the likely topic."""
    talk(session)
    file = tmp_path / 'run.mcap'
    file.write_text('older')
    with pytest.raises(TimeoutError, match=r'did you mean /chatter\?'):
        record(file, 'chater', seconds=0.3)

    assert file.read_text() == 'older'
    assert [one.name for one in tmp_path.iterdir()] == ['run.mcap']


@pytest.mark.parametrize(
    ('file', 'sources', 'seconds', 'why'),
    [
        ('chatter', [], 1.0, "record('run.mcap', 'chatter')"),
        ('run.mcap', [String], 1.0, 'name of a topic'),
        ('run.mcap', ['chatter'], 0, 'seconds: expected a number above 0'),
        ('run.mcap', ['chatter'], math.inf, 'seconds: expected a number above 0'),
        ('none/run.mcap', ['chatter'], 1.0, 'No such file or directory'),
    ],
)
def test_wrong_arguments_of_record_are_named(
    session, tmp_path, monkeypatch, file, sources, seconds, why
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RoslabError) as raised:
        record(file, *sources, seconds=seconds)

    assert why in str(raised.value)
    assert list(tmp_path.iterdir()) == []


def foreign(path):
    """Write an MCAP file as a different program would."""
    with path.open('wb') as stream:
        made = Writer(stream)
        made.start()
        schema = made.register_schema('Pose', 'jsonschema', b'{}')
        made.add_message(made.register_channel('/pose', 'json', schema), 1, b'{}', 1)
        made.finish()


def damaged(path, good):
    """Change a byte of a message."""
    data = bytearray(good.read_bytes())
    data[data.index('süß'.encode())] ^= 1
    path.write_bytes(data)


@pytest.mark.parametrize(
    ('make', 'why'),
    [
        (lambda path, good: None, 'there is no such file'),
        (lambda path, good: path.write_text('hello'), 'this is not an MCAP file'),
        (lambda path, good: path.write_bytes(b''), 'this is not an MCAP file'),
        (lambda path, good: path.write_bytes(good.read_bytes()[:8]), 'the end of this file'),
        (lambda path, good: path.write_bytes(good.read_bytes()[:-20]), 'the end of this file'),
        (damaged, 'this file is damaged'),
        (lambda path, good: foreign(path), '/pose contains json data, not ROS 2 messages'),
        (lambda path, good: path.mkdir(), 'this folder has no .mcap file'),
    ],
)
def test_unusable_file_is_refused_with_a_reason(everything, tmp_path, make, why):
    path = tmp_path / 'run.mcap'
    make(path, everything[0])
    with pytest.raises(BagError) as raised:
        list(messages_of(open_bag(path)))

    assert str(raised.value).startswith(f'{path}: ')
    assert why in str(raised.value)
    assert '\n' not in str(raised.value)


def test_changed_type_is_not_published(session, tmp_path, monkeypatch):
    """The bytes of an older type would be read as wrong values."""
    file = tmp_path / 'run.mcap'
    monkeypatch.setattr(writer, 'hash_of', lambda _: 'RIHS01_older')
    with writer.BagWriter(file) as bag:
        bag.add_topic('/chatter', 'std_msgs/msg/String')
        bag.write('/chatter', serialize_message(String()), 1, 1)
    with pytest.raises(BagError, match='has changed since /chatter was recorded'):
        replay(file)

    assert session.nodes() == {}


def test_simulation_is_saved_with_its_inputs_and_logs(session, tmp_path):
    """The times in the file equal the virtual times."""

    def topic(name, times, texts):
        data = tuple({'data': text} for text in texts)
        return TopicRecord(name, 'std_msgs/msg/String', times, data, 5.0)

    run = Simulation(
        'echo',
        {'/out': topic('/out', (2.0, 3.0), ('a', 'b'))},
        {},
        {'/in': topic('/in (input)', (1.0,), ('x',))},
        (LogRecord(2.5, 'WARN', 'echo', 'warm'),),
        'complete',
        5.0,
    )
    bag = record(tmp_path / 'run.mcap', run)
    read = [(one.topic, one.received_ns / 1e9) for one in messages_of(bag)]

    assert read == [('/in', 1.0), ('/out', 2.0), ('/rosout', 2.5), ('/out', 3.0)]
    assert {topic.name: topic.count for topic in bag.topics} == {'/in': 1, '/out': 2, '/rosout': 1}


def test_profiles_survive_the_file_and_older_releases(everything):
    """In recordings from releases before Jazzy, policies are numbers."""
    stored = plain_profiles([KEPT])
    again = profile_to_offer(yaml.safe_load(yaml.safe_dump(stored)))
    numbers = [{**stored[0], 'history': 3, 'reliability': 1, 'durability': 1, 'liveliness': 1}]

    assert (again.reliability, again.durability) == (KEPT.reliability, KEPT.durability)
    assert again.depth == profile_to_offer(numbers).depth == 10
    assert profile_to_offer(numbers).durability == DurabilityPolicy.TRANSIENT_LOCAL
    best_effort = plain_profiles([QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)])
    assert profile_to_offer(stored + best_effort).reliability == ReliabilityPolicy.RELIABLE


@pytest.fixture
def command(tmp_path, domain):
    """Return a function that starts the ros2 command in a folder and a separate domain."""

    def begin(*arguments):
        return subprocess.Popen(
            [sys.executable, '-m', 'roslab.ros2', *arguments],
            cwd=tmp_path,
            env={
                **overlaid(bare_shell(domain), ros_environment()),
                'PYTHONPATH': ':'.join(sys.path),
            },
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    return begin


@pytest.mark.parametrize('ending', [signal.SIGINT, signal.SIGTERM])
def test_command_records_until_it_is_stopped_and_plays(session, command, tmp_path, ending):
    """The folder has the layout of ``ros2 bag``, and info and play can read it."""
    sent = threading.Event()
    talk(session, then=lambda count: count == 100 and sent.set())
    recorder = command('bag', 'record', '-o', 'run', '/chatter')
    assert sent.wait(LIMIT_S)
    recorder.send_signal(ending)
    rest, _ = recorder.communicate(timeout=LIMIT_S)
    session.stop_all()

    assert "Subscribed to topic '/chatter'" in rest
    assert 'Traceback' not in rest
    assert sorted(one.name for one in (tmp_path / 'run').iterdir()) == [
        'metadata.yaml',
        'run_0.mcap',
    ]
    about = yaml.safe_load((tmp_path / 'run' / 'metadata.yaml').read_text())
    count = about['rosbag2_bagfile_information']['message_count']
    assert count == len(texts_of(tmp_path / 'run')) > 3
    printed, _ = command('bag', 'info', 'run').communicate(timeout=LIMIT_S)
    assert f'Topic: /chatter | Type: std_msgs/msg/String | Count: {count} |' in printed
    heard = Listener('chatter', String, KEPT)
    played = command('bag', 'play', 'run', '--loop')
    assert heard.wait(1, LIMIT_S)[0].data in texts_of(tmp_path / 'run')
    played.send_signal(signal.SIGINT)
    words, _ = played.communicate(timeout=LIMIT_S)
    assert 'Traceback' not in words


def test_command_refuses_what_it_cannot_use(command, tmp_path):
    (tmp_path / 'there').mkdir()
    for arguments, why in (
        (['info', 'none.mcap'], 'none.mcap: there is no such file'),
        (['record', '-o', 'there', '-a'], "Output folder 'there' already exists."),
        (['record'], 'Need to specify at least one option'),
    ):
        done = command('bag', *arguments)
        words, _ = done.communicate(timeout=LIMIT_S)
        assert (done.returncode, words.count('\n')) == (1, 1)
        assert why in words
