"""Simulations without ROS: the probe's instructions, and the contents of a recording."""

import pytest

from autograder.errors import UsageError
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, Feed, Join, Qos
from autograder.recording import Recording
from autograder.simulated import LogRecord
from autograder.simulation.order import order_of
from autograder.simulation.result import read_simulation
from autograder.simulation.run import planned
from autograder.simulation.virtual_time import files_of

STRING = 'std_msgs/msg/String'
LATCHED = {'reliability': 'RELIABLE', 'durability': 'TRANSIENT_LOCAL'}


def end(kind, topic, name=STRING):
    return {'kind': kind, 'topic': topic, 'type': name, 'node': '/echo', 'qos': LATCHED}


ENDS = [end('subscription', '/in'), end('publisher', '/out'), end('publisher', '/rosout')]
GRAPH = {
    'event': 'graph',
    'when': 'start',
    'clock_ns': 630_000_000,
    'nodes': [],
    'endpoints': ENDS,
}
SEEN = Recording({}, [GRAPH])


def steps_of(**wishes):
    return planned(order_of('echo.py', 10, **wishes), Scenario(), SEEN).steps


def send(text):
    return Feed('/in', ({'data': text},), every_s=0.0, rest_s=0.0)


def test_plan_watches_every_topic_that_the_program_publishes():
    scenario = planned(order_of('echo.py', 10), Scenario(), SEEN)

    assert scenario.watch == {'/out': STRING}
    assert scenario.feed == {}
    assert scenario.steps == (Advance(9.371),)


def test_inputs_of_one_second_are_a_burst_in_the_given_order():
    steps = steps_of(
        inputs={'in': [(2.0, {'data': 'b'}), (1.0, {'data': 'a'}), (2, {'data': 'c'})]}
    )

    assert steps == (
        *(Advance(0.37), send('a')),
        *(Advance(1.0), send('b'), send('c')),
        Advance(8.001),
    )


def test_late_subscription_asks_for_what_the_publisher_offers():
    """With the offered QoS, the subscription also receives stored messages."""
    steps = steps_of(late={'out': 3.0})
    qos = Qos('RELIABLE', 'TRANSIENT_LOCAL', depth=100)

    assert steps == (
        Advance(2.37),
        Join('late/out', '/out', STRING, qos, listen_s=0.0),
        Advance(6.801),
    )


def test_program_that_ends_at_once_gets_no_inputs():
    """The result is the crash of the program, not an error about its inputs."""
    order = order_of('echo.py', 10, inputs={'nowhere': [(1, {})]})

    assert planned(order, Scenario(), Recording({}, [])).steps == (Advance(10.0),)


@pytest.mark.parametrize(
    ('wishes', 'words'),
    [
        (
            {'inputs': {'inn': [(1, {})]}},
            'the program never subscribes to this topic. Did you mean /in?',
        ),
        ({'late': {'in': 1}}, '/in: the program never publishes on this topic. Known: /out.'),
        ({'inputs': {'in': [(0.5, {})]}}, 'expected a time of at least 0.63 s, got 0.5 s'),
        ({'late': {'out': 1}, 'inputs': {'in': [(1.1, {})]}}, 'expected a time of at least 1.2 s'),
        (
            {'inputs': {'in': [(11, {})]}},
            'inputs of /in: expected a time from 0 to 10 s',
        ),
        ({'late': {'out': float('nan')}}, 'late /out: expected a time from 0 to 10 s, got nan'),
        ({'inputs': {'in': [1, 2]}}, 'got something else'),
        ({'inputs': {'in': [(1, 'text')]}}, "'text' is neither a message nor a dict"),
    ],
)
def test_wrong_wish_is_refused_with_its_place(wishes, words):
    with pytest.raises(UsageError) as refused:
        steps_of(**wishes)

    assert words in str(refused.value)


@pytest.mark.parametrize('seconds', [0, -1, 86_401, float('nan'), float('inf')])
def test_impossible_length_is_refused(seconds):
    with pytest.raises(UsageError, match='seconds: expected more than 0 and at most 86400'):
        order_of('echo.py', seconds)


def test_numbers_that_json_lacks_and_inner_fields_become_plain_data():
    fields = {'value': float('nan'), 'stamp': {'sec': 1}, 'items': (1.5, float('-inf'))}
    (one,) = order_of('echo.py', 10, {'in': [(1, fields)]}).inputs

    assert one.fields == {'value': 'nan', 'stamp': {'sec': 1}, 'items': [1.5, '-inf']}


def recorded(
    *events,
    reason='complete',
    over_ns=10_001_000_000,
    exit_code=None,
    printed='',
    sent=None,
):
    """Return the result of a simulation of ten seconds."""
    ending = [
        {'event': 'end', 'clock_ns': over_ns, 'reason': reason},
        {'event': 'process', 'exit': exit_code, 'stdout': '', 'stderr': printed},
    ]
    topics = {'published': {'/out': STRING}, 'sent': sent or {'/in': STRING}}
    facts = {'exam': 'echo.py', 'mode': 'none', 'seconds': 10.0, **topics}
    return read_simulation(Recording(facts, [GRAPH, *events, *ending]))


def message(at_ns, text, **facts):
    data = {'data': text}
    return {'event': 'message', 'clock_ns': at_ns, 'topic': '/out', 'data': data, **facts}


def test_recording_becomes_messages_with_times():
    log = {'event': 'log', 'clock_ns': 5, 'level': 30, 'name': 'echo', 'text': 'hot'}
    sent = {'event': 'input', 'clock_ns': 10**9, 'topic': '/in', 'data': {'data': 'a'}}
    joined = {'event': 'joined', 'clock_ns': 2 * 10**9, 'topic': '/out', 'listener': 'late/out'}
    run = recorded(
        *(log, sent, joined),
        message(10**9, 'a'),
        message(2 * 10**9, 'a', listener='late/out'),
        message(10 * 10**9, 'b'),
        message(10 * 10**9 + 1, 'c'),
    )

    assert run.times('out') == [1.0, 10.0]
    assert run['/out'].data == ({'data': 'a'}, {'data': 'b'})
    assert run.late['/out'].times == (2.0,)
    assert run.sent['/in'].times == (1.0,)
    assert run.logged('warn') == [LogRecord(5e-9, 'WARN', 'echo', 'hot')]
    assert (run.reason, run.seconds, run.exit) == ('complete', 10.0, None)


def test_topic_that_is_sent_and_published_keeps_the_type_of_each():
    """ROS allows two types on one topic, although they do not connect."""
    run = recorded(sent={'/out': 'std_msgs/msg/Int32'})

    assert run['/out'].type == STRING
    assert run.sent['/out'].type == 'std_msgs/msg/Int32'


def test_topic_without_messages_is_empty_and_an_unknown_one_is_an_error():
    """A test that expects no message must not pass because of a misspelt topic."""
    run = recorded()

    assert run.times('/out') == []
    with pytest.raises(KeyError, match=r'/outt: the program has no such publisher.*/out'):
        run.times('outt')


def test_end_of_a_program_is_reported_with_its_last_line():
    printed = 'Traceback\nValueError: too much\n'
    run = recorded(reason='student_exited', over_ns=3 * 10**9, exit_code=1, printed=printed)

    assert run.ended == (
        'After 3 s of virtual time, the program ended with exit code 1: ValueError: too much'
    )


def test_limit_keeps_what_was_observed_until_then():
    run = recorded(message(4 * 10**9, 'a'), reason='cpu_limit', over_ns=None)

    assert (run.times('out'), run.seconds) == ([4.0], 4.0)
    assert (
        run.ended
        == 'After 4 s of virtual time, the program had used more than 20 s of processor time.'
    )


def test_modules_next_to_a_program_come_along(tmp_path):
    """Modules can be imported by name, and from a package that is named after the folder."""
    folder = tmp_path / 'my_package'
    folder.mkdir()
    for name in ('my_node.py', 'helper.py'):
        (folder / name).write_text(f'# {name}\n', encoding='utf-8')

    file, files = files_of(folder / 'my_node.py')

    assert file == 'my_node.py'
    assert sorted(files) == [
        'helper.py',
        'my_node.py',
        'my_package/helper.py',
        'my_package/my_node.py',
    ]


def test_entry_point_calls_its_function(tmp_path, monkeypatch):
    (tmp_path / 'some_node.py').write_text('def run():\n    pass\n', encoding='utf-8')
    monkeypatch.syspath_prepend(tmp_path)

    file, files = files_of('some_node:run')

    assert files[file] == 'import sys\nfrom some_node import run\nsys.exit(run())\n'
    assert 'some_node.py' in files


@pytest.mark.parametrize('program', ['nowhere.py', 'nowhere:main', 'nowhere.inner:main'])
def test_missing_program_is_refused(program):
    with pytest.raises(UsageError, match=r'there is no such file|has no such module'):
        files_of(program)
