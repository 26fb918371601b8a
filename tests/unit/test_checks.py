"""The functions that checks share, tested on handmade recordings."""

from dataclasses import replace

import pytest

from autograder.exam.exam import Failed, Run
from autograder.judging import checks, rhythm
from autograder.recording import Recording, WARN

TOPIC, TYPE = '/lab/reading', 'std_msgs/msg/String'
QOS = {'reliability': 'RELIABLE', 'durability': 'VOLATILE', 'deadline_ns': None}
END = {'topic': TOPIC, 'kind': 'publisher', 'node': '/lab/a', 'type': TYPE, 'qos': QOS}
HEARD = {**END, 'kind': 'subscription'}
GRAPH = {'event': 'graph', 'when': 'end', 'nodes': ['/lab/a'], 'endpoints': [END]}


def run_of(*events, **process):
    ends = [{'event': 'end', 'reason': 'complete'}, {'event': 'process', **process}]
    return Run({}, Recording({}, (*events, *ends)))


def message(clock_s, **data):
    return {'event': 'message', 'topic': TOPIC, 'clock_ns': round(clock_s * 1e9), 'data': data}


def log(text, level=WARN, name='lab.a'):
    return {'event': 'log', 'name': name, 'level': level, 'text': text, 'after_input': 0}


def messages(*clocks_s):
    return [message(clock) for clock in clocks_s]


def failure(check, *arguments, **facts):
    with pytest.raises(Failed) as failed:
        check(*arguments, **facts)
    return failed.value


class TestNode:
    def test_node_of_the_right_name_passes(self):
        checks.require_node(run_of(GRAPH), '/lab/a')

    def test_node_in_another_namespace_is_reported(self):
        failed = failure(checks.require_node, run_of(GRAPH), '/kitchen/a')

        assert failed.expected == 'a node called a in the namespace /kitchen'
        assert failed.observed == '/lab/a'
        assert failed.why.cause_id == 'namespace'

        assert failed.why.try_this.startswith('Give the node only its name')


class TestReached:
    def test_subscription_that_comes_after_the_start_fails_alone(self):
        """A late subscription misses messages, but other checks can still judge the later ones."""
        start = {**GRAPH, 'when': 'start', 'endpoints': []}
        sent = {'event': 'input', 'index': 0, 'topic': TOPIC}
        run = run_of(start, sent, {**GRAPH, 'endpoints': [HEARD]})

        failed = failure(checks.require_reached, run, TOPIC, TYPE)

        assert failed.why.cause_id == 'subscribed_late'
        assert not failed.blocks

    @pytest.mark.parametrize(('lost', 'passes'), [('/other', True), (TOPIC, False)])
    def test_topic_that_is_not_connected_fails_alone(self, lost, passes):
        """The run ends at this topic, so other topics are not blamed."""
        seen = [{**GRAPH, 'when': when, 'endpoints': [HEARD]} for when in ('start', 'end')]
        run = run_of(*seen, {'event': 'not_connected', 'topic': lost})

        assert (checks.why_not_reached(run, TOPIC, TYPE) is None) is passes


class TestEndpoint:
    def test_endpoint_of_another_type_is_named(self):
        failed = failure(
            checks.require_endpoint, run_of(GRAPH), 'publisher', TOPIC, 'std_msgs/msg/Int32'
        )

        assert failed.why.cause_id == 'wrong_type'

    def test_policies_are_compared_one_by_one(self):
        checks.require_qos([END], reliability='RELIABLE', deadline_ns=None)

        failed = failure(
            checks.require_qos, [END], reliability='RELIABLE', deadline_ns=200_000_000
        )

        assert failed.expected == 'deadline 0.2 s'
        assert failed.observed == 'deadline without limit'
        assert failed.why.cause_id == 'qos_deadline'


class TestMessages:
    def test_one_other_value_fails_and_is_shown(self):
        """The name of a nested field contains a dot."""
        found = [message(1, unit={'name': 'Celsius'}), message(2, unit={'name': 'celsius'})]

        failed = failure(checks.require_field, run_of(), found, 'unit.name', 'Celsius')

        assert failed.observed == "unit.name 'celsius'"
        assert 'case' in failed.why.text

    @pytest.mark.parametrize(
        'clocks', [[1.1, 2.1, 3.1], [1.1, 2.105, 3.1], [0.1, 1.1, 2.1, 3.1]], ids=str
    )
    def test_steady_messages_pass_wherever_they_begin(self, clocks):
        """A delay of some milliseconds, and one message more or less, are accepted."""
        rhythm.require_period(run_of(), messages(*clocks), 1.0, 3.0)

    @pytest.mark.parametrize(
        ('clocks', 'observed'),
        [
            ([1.1], 'one message'),
            ([1.1, 3.1, 5.1], '3 messages, 2 s apart'),
            ([1.1, 2.1, 4.1], '3 messages, 1 to 2 s apart'),
            ([number / 50 for number in range(200)], 'far more messages'),
        ],
        ids=['one', 'steady', 'a hole', 'flood'],
    )
    def test_rhythm_is_reported_in_words(self, clocks, observed):
        """No count is shown, because a flood is recorded only in part."""
        failed = failure(rhythm.require_period, run_of(), messages(*clocks), 1.0, 4.0)

        assert failed.observed == observed

    @pytest.mark.parametrize(
        ('clocks', 'waited_s', 'at'),
        [
            ([1.0, 2.0, 5.0, 6.0], 0.0, 3.0),
            ([1.0, 2.0], 0.0, 3.0),
            ([1.0, 1.5, 2.0, 2.5, 3.0], 0.0, 1.5),
            ([4.0, 5.0], 4.0, 1.0),
        ],
        ids=['a hole', 'the end', 'too often', 'late'],
    )
    def test_first_difference_is_where_a_message_is_missing_or_too_early(
        self, clocks, waited_s, at
    ):
        failed = failure(
            rhythm.require_period, run_of(), messages(*clocks), 1.0, 7.0, waited_s=waited_s
        )

        assert failed.at == at * checks.SECOND

    def test_first_message_comes_within_one_period(self):
        """The timer publishes no message in its first call."""
        found = messages(2.0, 3.0, 4.0)
        run = run_of({'event': 'mark', 'clock_ns': 4_500_000_000})
        waited_s = rhythm.seconds_between([{'event': 'seen', 'clock_ns': 0}], found)

        rhythm.require_period(run, found, 1.0, 4.0, waited_s=1.01)
        failed = failure(rhythm.require_period, run, found, 1.0, 4.0, waited_s=waited_s)

        assert failed.observed == '3 messages, 1 s apart, the first after 2 s'
        assert failed.why.cause_id == 'begins_late'

    @pytest.mark.parametrize(
        ('number', 'seconds'),
        [(5, [1, 2, 3, 4, 5, 6, 7]), (3, [1, 3, 5, 6, 7]), (2, [1, 5, 6, 7]), (1, [1, 5, 6, 7])],
    )
    def test_number_shows_what_was_published_without_a_subscription(self, number, seconds):
        """Each publisher numbers its messages; no subscription exists from second 1.5 to 4.5."""
        later = [{**message(5 + more), 'number': number + more} for more in range(3)]
        heard = [{**message(1), 'number': 1}, *later]
        run = run_of({'event': 'left', 'name': TOPIC, 'clock_ns': 1_500_000_000}, *heard)

        assert [one['clock_ns'] / 1e9 for one in rhythm.with_unheard(run, heard)] == seconds

    def test_greetings_before_the_first_subscription_are_as_far_apart_as_the_next_ones(self):
        """A later change of the rhythm does not move what the probe has not heard."""
        clocks = [*range(3, 10), *range(11, 60, 2)]
        found = [{**message(clock), 'number': number} for number, clock in enumerate(clocks, 3)]
        run = run_of({'event': 'left', 'name': TOPIC, 'clock_ns': 0}, *found)

        whole = rhythm.with_unheard(run, found)

        assert [one['clock_ns'] / 1e9 for one in whole[:4]] == [1, 2, 3, 4]
        assert rhythm.why_other_rhythm(run, whole, 1.0, 60.0).cause_id == 'changes_rhythm'

    @pytest.mark.parametrize(
        ('code', 'because_unheard'),
        [
            ('if node.publisher.get_subscription_count(): node.publish()', True),
            ('if node.ready: node.publish()', False),
        ],
    )
    def test_silence_without_a_subscription_is_explained(self, code, because_unheard):
        """The next number shows that no message was published meanwhile; the code shows why."""
        found = [{**message(clock), 'number': clock - 4} for clock in (5, 6, 7)]
        run = run_of({'event': 'left', 'name': TOPIC, 'clock_ns': 600_000_000}, *found)
        run = replace(run, files={'n.py': code})

        failed = failure(rhythm.require_period, run, rhythm.with_unheard(run, found), 1.0, 7.0)

        assert (failed.why.cause_id == 'only_if_heard') == because_unheard

    def test_new_publisher_is_no_silence(self):
        """Its numbers do not show how many messages were published without a subscription."""
        found = [{**message(clock), 'number': 1} for clock in (1, 2, 3, 7, 8, 9)]
        run = run_of({'event': 'left', 'name': TOPIC, 'clock_ns': 3_500_000_000}, *found)

        failed = failure(rhythm.require_period, run, rhythm.with_unheard(run, found), 1.0, 9.0)

        assert failed.why is None or failed.why.cause_id != 'only_if_heard'

    @pytest.mark.parametrize('answered', [True, False])
    def test_pause_explains_what_is_too_slow_before_the_rate_does(self, answered):
        code = 'node.create_timer(1.0, tick)\ndef tick():\n    time.sleep(2.0)\n'
        asked = {'event': 'asked', 'node': '/lab/a', 'answered': answered}
        run = replace(run_of(asked), files={'n.py': code})

        failed = failure(rhythm.require_period, run, messages(1, 3, 5), 1.0, 5.0)

        assert failed.why.cause_id == 'sleeps_in_callback'

    @pytest.mark.parametrize(
        ('clocks', 'end_s', 'cause'),
        [
            ([0.6, 1.1, 1.6, 2.1, 2.6, 3.1], 3.0, 'wrong_rate'),
            ([1.1, 3.1], 3.0, 'some_missing'),
            ([], 3.0, None),
            ([1.1, 1.1, 2.1, 3.1], 3.0, 'several_at_once'),
            ([1.1, 1.3, 2.1, 2.3, 3.1, 3.3], 3.0, 'several_timers'),
            ([1.1, 2.1, 3.1], 8.0, 'stops'),
        ],
        ids=['twice as fast', 'a hole', 'silence', 'doubled', 'two timers', 'the end'],
    )
    def test_other_rhythms_fail(self, clocks, end_s, cause):
        """A cause is named only if the evidence is certain."""
        failed = failure(rhythm.require_period, run_of(), messages(*clocks), 1.0, end_s)

        assert (failed.why and failed.why.cause_id) == cause

    @pytest.mark.parametrize(
        ('least', 'expected'),
        [(3, 'at least 3 messages on /lab/reading'), (1, 'messages on /lab/reading')],
    )
    def test_too_few_messages_fail(self, least, expected):
        failed = failure(
            checks.require_messages, run_of(GRAPH), [], least, 'messages on /lab/reading'
        )

        assert failed.expected == expected
        assert failed.why.cause_id == 'silent'


class TestLogs:
    def test_lines_of_others_do_not_count(self):
        """Child loggers count; a node whose name only begins with the same letters does not."""
        run = run_of(log('mine'), log('child', name='lab.a.kid'), log('other', name='lab.ab'))

        assert [one['text'] for one in checks.own_logs(run, '/lab/a')] == ['mine', 'child']


class TestAnswers:
    SERVICE = '/lab/a/change_state'

    def answer(self, **data):
        return {'event': 'answer', 'service': self.SERVICE, 'data': data}

    def test_wanted_answers_pass(self):
        run = run_of(self.answer(success=True, more=1), self.answer(success=False))

        checks.require_answers(run, self.SERVICE, [{'success': True}, {}], 'two transitions')

    def test_other_answer_is_reported_by_number(self):
        run = run_of(self.answer(success=True), self.answer(success=False))

        failed = failure(
            checks.require_answers, run, self.SERVICE, [{'success': True}] * 2, 'two transitions'
        )

        assert failed.expected == 'two transitions: success True in answer 2'
        assert failed.observed == 'success False'

    @pytest.mark.parametrize(
        ('reason', 'cause_id'), [('no_service', 'no_service'), ('too_late', 'no_response')]
    )
    def test_missing_service_or_response_is_the_cause(self, reason, cause_id):
        """A plain Node has no lifecycle services, and a callback may never return."""
        run = run_of({'event': 'no_answer', 'service': self.SERVICE, 'reason': reason})

        failed = failure(
            checks.require_answers, run, self.SERVICE, [{}], 'the transition configure'
        )

        assert failed.why.cause_id == cause_id


def test_lines_of_the_only_node_count_in_each_phase_whatever_its_name():
    """The graph of an earlier phase shows that there is only one node."""
    events = (
        {'event': 'graph', 'when': 'start', 'nodes': ['/mine'], 'endpoints': []},
        {'event': 'mark', 'name': 'silence', 'clock_ns': 0},
        {'event': 'log', 'name': 'mine', 'level': WARN, 'text': 'missed', 'after_input': None},
    )
    run = Run({}, Recording({}, events))

    assert checks.own_logs(run.during('silence'), '/sensor_watch', WARN) == [events[2]]
