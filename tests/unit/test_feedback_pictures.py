"""Pictures of failed checks: contents, hidden values, and size."""

from itertools import pairwise
import json
import re
from xml.etree import ElementTree

import pytest

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import FeedTopic, RosClock, Scenario
from autograder.exam.steps import Advance, Feed, Join, Offer, Qos
from autograder.explaining import picture_data
from autograder.explaining.feedback_html import exam_html
from autograder.explaining.picture_data import MOST_TIMES, pictures
from autograder.explaining.picture_svg import picture_html, timeline_words
from autograder.judging.judge import judge
from autograder.recording import Recording
from autograder.results import ExamResult

TOPIC, TYPE = '/lab/chatter', 'std_msgs/msg/String'
SECOND = 1_000_000_000
EVIL = '/<script>alert(1)</script>"\'&\x1b'


def end(topic=TOPIC, type_name=TYPE, kind='publisher', node='/lab/talker', **qos):
    whole = {'reliability': 'RELIABLE', 'durability': 'VOLATILE', **qos}
    return {'topic': topic, 'kind': kind, 'node': node, 'type': type_name, 'qos': whole}


def said(second, topic=TOPIC, **more):
    """Return a message at a virtual time [s]."""
    facts = {'event': 'message', 'topic': topic, 'data': {'data': 'SECRET'}, **more}
    return {**facts, 'clock_ns': round(second * SECOND)}


def fed(count, topic='/t'):
    facts = {'event': 'input', 'topic': topic, 'clock_ns': None, 'data': {}}
    return [{**facts, 'index': number} for number in range(count)]


def recorded(*events, ends=None, nodes=('/lab/talker',)):
    """Return a recording of a program with these endpoints."""
    graph = {
        'event': 'graph',
        'clock_ns': None,
        'when': 'end',
        'nodes': list(nodes),
        'endpoints': [end()] if ends is None else list(ends),
    }
    last = {'event': 'end', 'clock_ns': 10 * SECOND, 'reason': 'complete'}
    return Recording({}, (*events, graph, last))


def logged(after_input, name='lab.talker'):
    """Return a WARN line after an input."""
    facts = {'event': 'log', 'level': 30, 'text': 'SECRET', 'clock_ns': None}
    return {**facts, 'name': name, 'after_input': after_input}


def of_lines(*events, inputs=None, place=None):
    """Return the picture of a failed check that expects WARN lines after three inputs."""
    failure = Failed(expected='one WARN line after a reading', observed='others', place=place)
    return drawn(
        recorded(*(inputs or fed(3)), *events, ends=[end('/t', kind='subscription')]),
        failure,
        watch={},
        feed={'/t': TYPE},
        steps=(Feed('/t', ({'data': 'x'},)),),
    )


def drawn(recording, failure, hidden=False, **scenario):
    """Return the picture of a check that fails in this way, or None."""
    whole = {
        'file': 'talker.py',
        'watch': {TOPIC: TYPE, '/chatter': TYPE},
        'arguments': ('-r', '__ns:=/lab'),
        'steps': (Advance(10.0),),
        **scenario,
    }
    exam = Exam(
        'talker',
        title='T',
        assignment='a',
        part=1,
        cells=(),
        requires=(),
        scenario=Scenario(**whole),
    )
    exam.hidden = hidden

    @exam.check(points=1)
    def speaks(run):
        """It publishes String messages on chatter."""
        raise failure

    run = Run({}, recording, {})
    return pictures(exam, run, judge(exam, run)).get('speaks')


WRONG = Failed(expected='x', observed='y')
RATE = {'expected': 'one message every 1 s for 10 s', 'observed': 'others'}


def has_refusal(picture):
    """Return whether a picture is a graph with endpoints that do not match."""
    arrows = picture['arrows'] if picture and picture['kind'] == 'graph' else []
    return any('does not match' in arrow['remark'] for arrow in arrows)


class TestGraph:
    def test_another_topic_is_beside_the_expected_one(self):
        picture = drawn(recorded(ends=[end('/lab/chater')]), WRONG)
        names = 'node', 'topic', 'matched', 'remark'
        shown = {tuple(one[name] for name in names) for one in picture['arrows']}

        assert picture['kind'] == 'graph'
        assert shown == {
            ('/lab/talker', TOPIC, False, 'expected here, but missing'),
            ('/lab/talker', '/lab/chater', True, 'not required'),
            ('the checks, listening', TOPIC, False, ''),
        }

    @pytest.mark.parametrize(
        ('endpoint', 'failure', 'remark'),
        [
            (
                end(type_name='std_msgs/msg/Int32'),
                WRONG,
                'expected std_msgs/msg/String, but yours is std_msgs/msg/Int32',
            ),
            (
                end(reliability='BEST_EFFORT'),
                Failed(
                    expected='reliability RELIABLE',
                    observed='reliability BEST_EFFORT',
                    why=Cause('qos_reliability', 'Another one.', 'Pass 10.'),
                ),
                'expected reliability RELIABLE, observed reliability BEST_EFFORT',
            ),
        ],
        ids=['type', 'quality of service'],
    )
    def test_another_type_or_quality_of_service_is_named(self, endpoint, failure, remark):
        assert drawn(recorded(ends=[endpoint]), failure)['arrows'][0]['remark'] == remark

    def test_quality_of_service_of_one_topic_leaves_the_others_as_they_should_be(self):
        """A check of a publisher does not change the node's subscription in the picture."""
        failure = Failed(
            expected='durability TRANSIENT_LOCAL',
            observed='durability VOLATILE',
            why=Cause('qos_durability', 'Another one on /chatter.', 'Pass a profile.'),
        )
        ends = [end(), end('/survey', kind='subscription')]
        picture = drawn(recorded(ends=ends), failure, feed={'/survey': FeedTopic(TYPE)})

        assert {arrow['topic'] for arrow in picture['arrows']} == {TOPIC}

    @pytest.mark.parametrize(
        ('cause', 'shown'),
        [('It keeps no message: its durability is volatile.', True), ('It is inactive.', False)],
    )
    def test_refused_late_subscription_is_shown_only_if_it_is_the_cause(self, cause, shown):
        """An exam may require that the program refuses a subscription."""
        late = {'event': 'joined', 'clock_ns': 0, 'topic': TOPIC, 'listener': 'late'}
        failure = Failed(
            expected='messages on chatter', observed='none', why=Cause('mute', cause, 'Change it.')
        )
        picture = drawn(
            recorded({**late, 'matched': False, 'refused': ['DURABILITY']}),
            failure,
            steps=(Join('late', TOPIC, TYPE), Advance(10.0)),
        )

        assert has_refusal(picture) is shown

    @pytest.mark.parametrize('matched', [True, False])
    def test_a_publisher_that_is_meant_to_be_refused_is_no_mistake(self, matched):
        """If another publisher matches, the subscription is right to refuse this one."""
        facts = {'event': 'offered', 'clock_ns': 0, 'topic': '/scan'}
        lazy = {**facts, 'publisher': 'lazy', 'matched': False, 'refused': ['DEADLINE']}
        right = {**facts, 'publisher': 'right', 'matched': matched, 'refused': []}
        failure = Failed(expected='a WARN line for a missed deadline of scan', observed='none')
        offers = tuple(Offer(name, '/scan', TYPE, Qos()) for name in ('lazy', 'right'))
        picture = drawn(
            recorded(lazy, right, ends=[end(), end('/scan', kind='subscription')]),
            failure,
            steps=(*offers, Advance(1.0)),
        )

        assert has_refusal(picture) is not matched

    def test_a_value_in_a_message_and_a_program_without_a_node_have_no_picture(self):
        value = Failed(expected="unit 'Celsius' in every message", observed='others')

        assert drawn(recorded(said(1.0)), value) is None
        assert drawn(recorded(ends=[], nodes=[]), Failed(**RATE)) is None


LOG = {'event': 'log', 'level': 20, 'text': 'x', 'clock_ns': SECOND, 'after_input': None}


class TestTimeline:
    """The timeline shows messages that came too rarely, too often or too late."""

    def test_the_rows_are_what_was_due_and_what_came(self):
        failure = Failed(**RATE, at=3 * SECOND, every_s=1.0)
        picture = drawn(recorded(*(said(one + 0.1) for one in (1, 2, 4))), failure)
        due, came = picture['rows']

        assert (picture['unit'], picture['deviation']) == ('seconds', 3.0)
        assert (due['what'], due['times'][:3]) == ('expected', [0.1, 1.1, 2.1])
        assert (came['label'], came['times'], came['count']) == (TOPIC, [1.1, 2.1, 4.1], 3)

    def test_times_are_those_of_the_ros_clock_that_the_program_follows(self):
        """If ROS time runs 25 % faster, a message every 0.8 s is one per ROS second."""
        failure = Failed(**RATE, at=round(2.4 * SECOND), every_s=0.8)
        came = (said(one) for one in (0.8, 1.6, 2.8))
        picture = drawn(recorded(*came), failure, ros_clock=RosClock(rate=1.25))

        assert (picture['unit'], picture['deviation']) == ('ros_seconds', 3.0)
        assert [row['times'][:3] for row in picture['rows']] == [[1.0, 2.0, 3.0], [1.0, 2.0, 3.5]]
        assert 'one every 1 s' in picture_html(picture)
        assert 'ROS seconds' in picture_html(picture)

    def test_silence_is_a_row_too(self):
        picture = drawn(recorded(), Failed(**RATE, every_s=1.0))

        assert [row['count'] for row in picture['rows']] == [10, 0]

    def test_inputs_and_log_lines_are_numbered_by_message(self):
        """A line before the first input counts too: a check may concern such lines."""
        picture = of_lines(logged(None), logged(1))

        assert picture['unit'] == 'input'
        assert [(row['label'], row['times'], row['count']) for row in picture['rows']] == [
            ('sent on /t', [1.0, 2.0, 3.0], 3),
            ('WARN lines', [0.0, 2.0], 2),
        ]
        assert (picture['begin'], picture['end']) == (0.0, 3.0)

    def test_line_of_another_logger_is_not_counted(self):
        picture = of_lines(logged(1, 'mine'), logged(2, 'lab.talker.child'))

        assert picture['rows'][1]['times'] == [3.0]

    def test_difference_at_an_input_that_was_not_sent_is_on_the_axis(self):
        picture = of_lines(logged(0), logged(1), logged(2), place=4)

        assert (picture['end'], picture['deviation']) == (5.0, 5.0)
        assert [row['times'][-1] for row in picture['rows']] == [3.0, 3.0]

    def test_input_of_a_late_publisher_is_named_by_its_topic(self):
        """Learners do not know the names that an exam gives its publishers."""
        offered = [
            {'event': 'offered', 'publisher': name, 'topic': '/t', 'matched': True, 'refused': []}
            for name in ('sensor', 'other')
        ]
        picture = of_lines(*offered, inputs=[*fed(2, 'sensor'), *fed(1, 'other')])

        assert [row['label'] for row in picture['rows']] == ['sent on /t', 'WARN lines']
        assert picture['rows'][0]['count'] == 3

    @pytest.mark.parametrize('name', ['/lab/keeper', 'the keeper'])
    def test_lines_are_those_of_the_node_that_is_meant(self, name):
        failure = Failed(expected=f'7 INFO lines from {name} in 14 s', observed='none')
        picture = drawn(
            recorded({**LOG, 'name': 'lab.talker'}, nodes=['/lab/keeper', '/lab/talker']),
            failure,
        )

        assert [(row['label'], row['count']) for row in picture['rows']] == [
            ('INFO lines of /lab/keeper', 0)
        ]

    def test_all_lines_are_in_one_row_if_the_check_names_none_of_the_nodes(self):
        """So no line is missing, even that of a logger that belongs to no node."""
        nodes = [f'/lab/node_{number}' for number in range(9)]
        names = [f'lab.node_{number}' for number in range(9)]
        lines = [{**LOG, 'name': name} for name in (*names, 'rcl')]
        failure = Failed(expected='7 INFO lines in 14 s', observed='others')
        picture = drawn(recorded(*lines, nodes=nodes), failure)

        assert [(row['label'], row['count']) for row in picture['rows']] == [('INFO lines', 10)]

    def test_a_long_run_is_shown_around_the_difference(self):
        """Sixty ticks would be too narrow, so the picture shows only those near the difference."""
        failure = Failed(**RATE, at=30 * SECOND, every_s=1.0)
        picture = drawn(recorded(*(said(one) for one in range(1, 60))), failure)

        assert picture['end'] - picture['begin'] <= 24
        assert picture['begin'] < 30 < picture['end']
        row = picture['rows'][1]
        assert row['count'] == 59
        assert all(picture['begin'] <= time <= picture['end'] for time in row['times'])
        words = f'59 in the run, {len(row["times"])} of them shown, from'
        assert words in timeline_words(picture)

    def test_part_of_a_long_run_shows_every_message(self):
        events = [said(number / 2) for number in range(1000)]
        picture = drawn(recorded(*events), Failed(**RATE, at=100 * SECOND, every_s=1.0))

        *_, row = picture['rows']
        assert {b - a for a, b in pairwise(row['times'])} == {0.5}


class TestSecrets:
    """A picture of a hidden exam shows only names and times."""

    def test_no_value_is_in_any_picture(self):
        picture = drawn(recorded(said(1.0)), Failed(**RATE, at=SECOND, every_s=1.0))

        assert 'SECRET' not in json.dumps(picture)

    def test_a_hidden_namespace_and_moment_stay_hidden(self):
        graph = drawn(recorded(ends=[end('/lab/x')]), WRONG, hidden=True)
        line = drawn(recorded(said(1.137)), Failed(**RATE, at=SECOND), hidden=True)

        assert '/lab' not in json.dumps(graph) + json.dumps(line)
        assert line['rows'][0]['times'] == [1.1]

    def test_the_order_of_hidden_inputs_is_not_shown(self):
        """The positions of the messages that get a warning would reveal answers."""
        inputs = fed(2, TOPIC)
        failure = Failed(expected='one WARN line', observed='no WARN line')

        assert drawn(recorded(*inputs, said(1.0)), failure) is not None
        assert drawn(recorded(*inputs, said(1.0)), failure, hidden=True) is None
        assert drawn(recorded(inputs[0], said(1.0)), failure) is None  # nothing to compare


class TestDrawing:
    @pytest.fixture(params=['graph', 'timeline'])
    def picture(self, request):
        """Return a picture of each kind that contains a hostile name."""
        if request.param == 'graph':
            ends = [end(EVIL, node=EVIL)]
            return drawn(recorded(ends=ends, nodes=[EVIL]), WRONG)
        failure = Failed(**RATE, at=3 * SECOND, every_s=1.0)
        return drawn(recorded(said(1, EVIL), ends=[end(EVIL)]), failure, watch={EVIL: TYPE})

    def test_it_is_well_formed_and_has_a_name_and_words(self, picture):
        page = picture_html(picture)
        tree = ElementTree.fromstring(re.search(r'<svg.*</svg>', page, re.DOTALL)[0])
        names = {one.tag.rpartition('}')[2] for one in tree.iter()}

        assert tree.get('role') == 'img'
        assert tree.find('{*}title').text
        assert tree.find('{*}desc').text
        assert not names & {'script', 'image', 'a', 'foreignObject', 'style'}
        assert 'http' not in page.replace('http://www.w3.org/2000/svg', '')

    def test_equal_results_give_equal_pages(self, picture):
        assert picture_html(picture) == picture_html(json.loads(json.dumps(picture)))

    def test_result_without_a_picture_has_none(self):
        assert picture_html({}) == ''
        assert '<svg' not in exam_html(ExamResult('talker', ()))

    def test_size_is_bounded(self, monkeypatch):
        monkeypatch.setattr(picture_data, 'MOST_EVENTS', 1000)
        topic = f'/{"x" * 255}'
        events = [said(one / 1000, topic) for one in range(20_000)]
        ends = [end(f'/{number}{"x" * 250}') for number in range(300)]
        failure = Failed(expected='10 messages', observed='20000')
        line = drawn(recorded(*events, ends=ends), failure, watch={topic: TYPE})
        graph = drawn(recorded(ends=ends), WRONG)

        assert all(len(row['times']) <= MOST_TIMES for row in line['rows'])
        assert len(picture_html(line)) < 20_000
        assert len(picture_html(graph)) < 10_000
