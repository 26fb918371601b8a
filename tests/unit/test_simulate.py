"""Simulations without ROS: the probe's instructions, and the contents of a recording."""

from collect_sources import laid
from handmade_runs import at, message, publisher
import pytest

from autograder.errors import UsageError
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, Feed, Join, Qos
from autograder.recording import Recording
from autograder.simulated import LogRecord
from autograder.simulation.documents import order_of, read_simulation
from autograder.simulation.run import planned
from autograder.simulation.virtual_time import files_of

STRING = 'std_msgs/msg/String'
LATCHED = {'reliability': 'RELIABLE', 'durability': 'TRANSIENT_LOCAL'}


END = publisher('/out', '/echo', STRING, qos=LATCHED)
ENDS = [{**END, 'topic': '/in', 'kind': 'subscription'}, END, {**END, 'topic': '/rosout'}]
GRAPH = at(0.63, 'graph', when='start', nodes=[], endpoints=ENDS)
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
    inputs = [(2.0, {'data': 'b'}), (1.0, {'data': 'a'}), (2, {'data': 'c'})]
    first, second = (Advance(0.37), send('a')), (Advance(1.0), send('b'), send('c'))

    assert steps_of(inputs={'in': inputs}) == (*first, *second, Advance(8.001))


def test_late_subscription_asks_for_what_the_publisher_offers():
    """With the offered QoS, the subscription also receives stored messages."""
    qos = Qos('RELIABLE', 'TRANSIENT_LOCAL', depth=100)
    join = Join('late/out', '/out', STRING, qos, listen_s=0.0)

    assert steps_of(late={'out': 3.0}) == (Advance(2.37), join, Advance(6.801))


def test_program_that_ends_at_once_gets_no_inputs():
    """The result is the crash of the program, not an error about its inputs."""
    order = order_of('echo.py', 10, inputs={'nowhere': [(1, {})]})

    assert planned(order, Scenario(), Recording({}, [])).steps == (Advance(10.0),)


@pytest.mark.parametrize(
    ('wishes', 'words'),
    [
        ({'inputs': {'inn': [(1, {})]}}, 'never subscribes to this topic. Did you mean /in?'),
        ({'late': {'in': 1}}, '/in: the program never publishes on this topic. Known: /out.'),
        ({'inputs': {'in': [(0.5, {})]}}, 'expected a time of at least 0.63 s, got 0.5 s'),
        ({'late': {'out': 1}, 'inputs': {'in': [(1.1, {})]}}, 'expected a time of at least 1.2 s'),
        ({'inputs': {'in': [(11, {})]}}, 'inputs of /in: expected a time from 0 to 10 s'),
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


def recorded(*events, reason='complete', over_ns=10_001_000_000, sent=None, **process):
    """Return the result of a simulation of ten seconds."""
    process = {'event': 'process', 'exit': None, 'stdout': '', 'stderr': '', **process}
    ending = [{'event': 'end', 'clock_ns': over_ns, 'reason': reason}, process]
    topics = {'published': {'/out': STRING}, 'sent': sent or {'/in': STRING}}
    facts = {'exam': 'echo.py', 'mode': 'none', 'seconds': 10.0, **topics}
    return read_simulation(Recording(facts, [GRAPH, *events, *ending]))


def published(clock_s, text, **facts):
    return message(clock_s, '/out', {'data': text}, **facts)


def test_recording_becomes_messages_with_times():
    run = recorded(
        at(5e-9, 'log', level=30, name='echo', text='hot'),
        at(1.0, 'input', topic='/in', data={'data': 'a'}),
        at(2.0, 'joined', topic='/out', listener='late/out'),
        published(1.0, 'a'),
        published(2.0, 'a', listener='late/out'),
        published(10.0, 'b'),
        published(10.0 + 1e-9, 'c'),
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
    run = recorded(reason='student_exited', over_ns=3 * 10**9, exit=1, stderr=printed)

    what = 'the program ended with exit code 1: ValueError: too much'
    assert run.ended == f'After 3 s of virtual time, {what}'


def test_limit_keeps_what_was_observed_until_then():
    run = recorded(published(4.0, 'a'), reason='cpu_limit', over_ns=None)

    assert (run.times('out'), run.seconds) == ([4.0], 4.0)
    what = 'the program had used more than 20 s of processor time.'
    assert run.ended == f'After 4 s of virtual time, {what}'


def test_modules_next_to_a_program_come_along(tmp_path):
    """Modules can be imported by name, and from a package that is named after the folder."""
    names = {'my_node.py', 'helper.py'}
    folder = laid(tmp_path / 'my_package', dict.fromkeys(names, b'#\n'))

    file, files = files_of(folder / 'my_node.py')

    assert file == 'my_node.py'
    assert set(files) == {*names, *(f'my_package/{name}' for name in names)}


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
