"""Causes that follow from the whole run: answered inputs, and disturbed rhythms."""

from dataclasses import replace
import math
from types import SimpleNamespace

from handmade_runs import at, graph, message, publisher, run_of, sent, why
import pytest

from autograder.exam.patterns import why_burst_cut, why_left_out, why_pattern
from autograder.exam.specification import each, Specification
from autograder.judging import rhythm
from autograder.judging.judge import closest
from autograder.judging.log_rows import require_warnings
from autograder.judging.numbers import shown, why_not_numbered
from autograder.judging.rows import delays, why_other_answer
from autograder.recording import ERROR, WARN
from autograder.submission.code.source_code import Code
from exams.visible import (
    courier,
    inspector,
    limit_keeper,
    managed_beacon,
    managed_pressure,
    map_server,
    sensor_watch,
)


@pytest.mark.parametrize(
    ('came', 'cause_id'),
    [
        ([1, 0, 0, 0], 'first_only'),
        ([1, 1, 0, 0], 'first_only'),
        ([0, 1, 1, 1], 'all_but_first'),
        ([1, 0, 1, 0], 'every_nth'),
        ([1, 1, 0, 1, 1, 0], 'leaves_out_every_nth'),
        ([1, 2, 3, 4], 'one_more_each_time'),
        ([1, 2, 2, 2], 'twice_from_then_on'),
        ([1, 0, 0, 1], None),
        ([1, 1, 1, 2], None),
        ([0, 0, 0, 0], None),
        ([1, 1, None, None], None),
    ],
    ids=str,
)
def test_pattern_is_named_if_all_answers_fit_it(came, cause_id):
    """In a run that ended early, only the inputs that were sent are evidence."""
    found = why_pattern([1] * len(came), came)

    assert (found and found.cause_id) == cause_id


def test_answer_without_an_expected_one_is_no_pattern():
    """Answers follow the wrong inputs, so the cause is not a missing answer."""
    assert why_pattern([1, 0, 1, 1], [1, 1, 0, 0]) is None


@pytest.mark.parametrize(
    ('counts', 'cause'),
    [
        ([1, 1, 0, 1, 0, 1], 'only_new_answers'),
        ([0, 1, 1, 0, 0, 1], 'only_true_answers'),
        ([1, 1, 0, 1, 0, 0], None),
        ([1, 1, 0, 1, 0, None], None),
        ([1, 1, 1, 1, 1, 1], None),
    ],
)
def test_answers_left_out_for_their_values_are_recognised(counts, cause):
    """Only if every answer and every gap fits."""
    near = Specification([False, True, True, False, False, True], each(lambda one: (one,)))
    came = [None if count is None else (True,) * count for count in counts]

    found = why_left_out(near, came)

    assert (found and found.cause_id) == cause


@pytest.mark.parametrize(
    ('came', 'cause_id'),
    [
        (('a',), 'drops_while_busy'),
        (('d',), 'only_the_last'),
        (('b', 'c', 'd'), 'only_the_last'),
        (('a', 'b', 'c'), 'the_rest_dropped'),
        (('a', 'd'), None),
    ],
    ids=str,
)
def test_burst_shows_which_messages_are_answered(came, cause_id):
    """First only: the node was busy. First few: a queue was full. Last ones: a small depth."""
    asked = Specification('abcd', each(lambda one: (one,)), burst=4)

    found = why_burst_cut(asked, came)

    assert (found and found.cause_id) == cause_id


def test_part_of_a_burst_is_not_taken_for_a_depth():
    asked = Specification('abcd', each(lambda one: (one,)), burst=4)

    assert why_other_answer(asked, [('b', 'c')], 0).cause_id == 'misses_some'


@pytest.mark.parametrize(
    ('late_s', 'came', 'says'),
    [
        ([[0.0, 0.0], [0.0]], [('a', 'a'), ('b',)], 'Publish once in the callback, and nowhere'),
        ([[0.0, 0.4], [0.0]], [('a', 'a'), ('b',)], 'never again from a timer, loop or thread'),
        ([[0.0], [0.0]], [('a',), ('c',)], 'depth 10'),
        ([[0.03], [0.01]], [('a',), ('c',)], 'depth 10'),
        ([[0.03], [0.04]], [('a',), ('c',)], 'not in a timer'),
    ],
    ids=['at once', 'again later', 'last only', 'one at once', 'last only, always late'],
)
def test_delay_of_an_answer_shows_a_timer(late_s, came, says):
    """A callback answers at once, a timer only at its next tick."""
    asked = Specification('abc', each(lambda one: (one,)), burst=2)
    place = int(len(came[0]) == 1)

    assert says in why_other_answer(asked, came, place, late_s).try_this


def test_delays_are_counted_from_the_input_or_the_end_of_a_burst():
    """A run that ended early, and an exam with a slow callback, give no delays."""
    asked = Specification('abc', each(lambda one: (one,)), burst=2)
    inputs = sent(1.0, 3.0, 3.5)
    answers = [message(1.25, after_input=0), message(4.0, after_input=2)]
    slow = {'slow_callback': True, 'letters': asked}

    def found(events, facts):
        return delays(run_of(*events, facts=facts), 'letters', '/alive')

    assert found([*inputs, *answers], {'letters': asked}) == [[0.25], [0.5]]
    assert found([*inputs[:2], *answers[:1]], {'letters': asked}) == []
    assert found([*inputs, *answers], slow) == []


def test_count_that_goes_back_is_reported_with_what_else_happened():
    found = [message(clock) for clock in (1.0, 2.0, 3.0)]
    run = run_of(*found, at(2.6, 'joined', matched=True))
    texts = ['hello 1', 'hello 2', 'hello 1']

    cause = why_not_numbered(texts, 2, when=rhythm.just_before(run, found, 2))

    assert cause.text.endswith('Just then, a subscription connects.')
    assert rhythm.just_before(run, found, 1) == ''


@pytest.mark.parametrize(
    ('code', 'says'),
    [
        ('n += 1\nif n > 9:\n    n = 0', 'begin again.'),
        ('def tick(self):\n    self.n += 1\n    self.n = 0', 'your code resets it.'),
        ("n += 1\nif n % 5 == 0 or n % 7:\n    show(f'hello {n % 24}')", 'the remainder of'),
        ('n += 1\nif n % 5 == 0 or n % 7:\n    show(n)', 'begin again.'),
        ('numbers = cycle(range(1, 9))', 'cycle() repeats them.'),
    ],
)
@pytest.mark.parametrize('texts', [['hello 7', 'hello 8', 'hello 1'], ['8', '9', '0']])
def test_numbers_that_begin_again_are_explained_by_what_the_program_does(code, says, texts):
    first = int(texts[0][-1])

    cause = closest(Code({'n.py': code}), why_not_numbered(texts, 2, first))

    assert (cause.cause_id, says in cause.text) == ('begins_again', True)
    assert f'After {first + 1} texts' in cause.text or 'goes back after' in cause.text


@pytest.mark.parametrize(
    ('clocks', 'others', 'cause_id'),
    [
        ([1, 1.7, 2, 3, 4], [at(1.7, 'input', index=0)], 'additional'),
        ([1, 1.7, 2, 3, 4], [message(1.7, '/results')], 'additional'),
        ([1.7, 2, 3, 4], [at(1.7, 'input', index=0)], 'additional'),
        ([1, 1.7, 2, 3, 4], [at(1.7, 'joined', matched=True)], 'additional'),
        ([1, 1.7, 2, 3, 4], [at(1.7, 'joined', matched=False)], None),
        ([1, 2, 3.4, 4.4], [message(2.4, '/results')], 'timer_reset'),
        ([1, 2, 3.4, 4.9], [at(2.4, 'input', index=0), message(3.9, '/results')], 'timer_reset'),
        ([1, 1, 3, 3, 5, 5, 7, 7], [], 'several_at_once'),
        ([16, 17, 18, 19], [], 'begins_late'),
        ([1, 2, 3, 4], [], 'stops'),
        ([1, 1.7, 2, 3, 4], [at(1.2, 'input', index=0)], None),
    ],
    ids=[
        'by an input',
        'by a result',
        'by the first',
        'by a subscription',
        'by one that does not connect',
        'reset',
        'reset by two kinds of events',
        'in pairs',
        'late',
        'ends early',
        'nothing at that moment',
    ],
)
def test_what_disturbs_a_rhythm_is_reported(clocks, others, cause_id):
    found = [message(clock) for clock in clocks]

    cause = why(rhythm.require_period, run_of(*found, *others), found, 1.0, 15.0)

    assert (cause and cause.cause_id) == cause_id


@pytest.mark.parametrize(
    ('clocks', 'text'),
    [
        ([1, 2, 2, 3, 4, 4, 5, 6, 6], 'at the same moment, once in 2 periods.'),
        ([1, 2, 2, 3, 3, 4, 5, 5], 'at the same moment.'),
        ([1, 1, 2, 2, 3, 3, 4, 4], 'at the same moment.'),
    ],
    ids=['every second', 'uneven', 'each'],
)
def test_second_message_that_comes_evenly_has_its_period(clocks, text):
    found = [message(clock) for clock in clocks]

    assert why(rhythm.require_period, run_of(), found, 1.0, 4.0).text.endswith(text)


@pytest.mark.parametrize('code', ['next(self.texts, None)', 'next(self.numbers)'])
def test_iterator_that_ends_is_the_cause_if_its_end_is_expected(code):
    """Without a second argument, next() raises an exception at the end of an iterator."""
    found = [message(clock) for clock in (1, 2, 3, 4)]
    run = run_of(code=code)

    cause = closest(Code(run.files), why(rhythm.require_period, run, found, 1.0, 15.0))

    assert (cause.cause_id, 'next()' in cause.text) == ('stops', 'None' in code)


TWO = """\
class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name)
        self.create_timer(period_s, self.report)
    def report(self):
        self.ticks += 1
        if self.ticks % 3 == 0:
            self.publisher.publish(Empty())
Watcher('a', 1.0)
"""
TURNS = 'rclpy.spin_once(a)\nrclpy.spin_once(b)\n'


@pytest.mark.parametrize(
    ('code', 'every_s', 'cause_id', 'advice'),
    [
        (TWO, 3.0, 'not_each_tick', 'Give create_timer() the period 1.0, and send'),
        (TWO, 2.5, 'wrong_rate', 'Send one message in each call'),
        (TWO.replace('1.0', '2.5'), 2.5, 'wrong_rate', 'The first argument of create_timer()'),
        (TWO.replace('% 3', '> 3'), 3.0, 'not_each_tick', 'Give create_timer()'),
        (TURNS, 2.0, 'spun_in_turn', 'Add each node to one executor'),
    ],
    ids=['each third tick', 'right period', 'wrong period', 'compared', 'in turn'],
)
def test_right_period_in_the_code_is_not_to_be_corrected(code, every_s, cause_id, advice):
    found = [message(every_s * number) for number in range(1, 6)]
    run = run_of(graph(nodes=['/a', '/b']), code=code)

    cause = closest(Code(run.files), why(rhythm.require_period, run, found, 1.0, 15.0))

    assert cause.cause_id == cause_id
    assert cause.try_this.startswith(advice)


def test_pause_with_a_reset_is_told_to_leave_the_reset_out():
    """Without a reset, a pause shorter than the period delays no later tick."""
    code = 'node.create_timer(1.0, tick)\ndef tick():\n    time.sleep(0.2)\n    timer.reset()\n'
    found = [message(1.2 * number) for number in range(1, 12)]

    assert 'reset()' in why(rhythm.require_period, run_of(code=code), found, 1.0, 15.0).try_this


def test_warning_from_another_line_is_not_called_a_repetition():
    asked = Specification([SimpleNamespace(kind='hot')] * 2, each(lambda one: 1))
    line = at(0.0, 'log', level=WARN, text='hot', line=20, after_input=0)
    lines = [[line], [line, {**line, 'line': 38}]]

    found = why(require_warnings, run_of(*sent(0.0)), asked, lines, [1], [], None)

    assert (found.cause_id, found.line) == ('other_warning', 38)


QUIET = tuple(message(half / 2) for half in range(1, 7))
RESULT = message(4.4, '/results')
LOCK = 'MultiThreadedExecutor()\nReentrantCallbackGroup()\nlock = threading.Lock()\n'
WAITING = (
    *(*QUIET, *sent(3.2, 5.7, 5.7)),
    *map(message, (3.5, 4.0, 4.5, 5.0, 5.5, 7.0, 7.5)),
    *(message(clock, '/results') for clock in (4.4, 6.9, 8.1)),
)


@pytest.mark.parametrize(
    ('events', 'code', 'cause_id'),
    [
        pytest.param((*QUIET, RESULT, message(4.4), message(4.5)), '', 'starved', id='waits'),
        pytest.param((*QUIET, message(3.5), message(4.0), RESULT), '', None, id='goes on'),
        pytest.param(
            (message(3.2), RESULT, message(5.7), message(6.9, '/results')),
            *('', None),
            id='beats with the pictures',
        ),
        pytest.param(QUIET, '', None, id='no result'),
        # More threads would not help, because both callbacks need the lock.
        pytest.param((*QUIET, RESULT, message(4.4)), LOCK, 'waits_for_lock', id='lock'),
        # A single picture delays nothing, so the timer does not simply wait for the callback.
        pytest.param(WAITING, 'MultiThreadedExecutor()\n', 'threads_used_up', id='threads'),
        pytest.param(WAITING, 'rclpy.spin(node)\n', None, id='one thread'),
    ],
)
def test_cause_of_missing_heartbeats_is_named_only_if_all_messages_fit_it(events, code, cause_id):
    found = inspector.why_starved(run_of(*events, code=code))

    assert (found and found.cause_id) == cause_id


@pytest.mark.parametrize(
    ('name', 'line', 'cause_id'),
    [
        ('delivers_late', 'time.sleep(3.0)', 'sleeps_before'),
        ('delivers_late', 'pass', 'delivers_late'),
        ('delivers_again', 'self.done = False', 'forgets_delivery'),
        ('delivers_again', 'pass', 'delivers_again'),
    ],
)
def test_parcel_is_blamed_on_what_the_code_has(name, line, cause_id):
    code = f'self.done = False\ncreate_timer(0.1, look)\ndef look():\n    {line}\n'

    assert closest(Code({'n.py': code}), courier.WHY[name]).cause_id == cause_id


def watched(*events):
    """Return a run of the node that listens to the sensor."""
    end = publisher('/distance', sensor_watch.NODE, sensor_watch.TYPE, kind='subscription')
    seen = graph({**end, 'qos': {'deadline_ns': sensor_watch.DEADLINE_NS}})
    return run_of(seen, *events, facts=sensor_watch.exam.facts)


def logged(clock_s, level=WARN, line=30, after_input=None):
    fields = {'name': 'sensor_watch', 'level': level, 'line': line, 'text': 'DEADLINE'}
    return at(clock_s, 'log', after_input=after_input, **fields)


class TestSensor:
    @pytest.mark.parametrize(
        ('early_s', 'cause_id'), [(1.3, 'own_watchdog'), (1.0, 'warns_of_something_else')]
    )
    def test_watchdog_that_runs_from_the_start_is_reported(self, early_s, cause_id):
        offer = at(1.0, 'offered', publisher='weak', matched=False, refused=['DEADLINE'])
        silence = at(5.0, 'mark', name='silence')

        run = watched(offer, logged(early_s), silence, logged(5.3, after_input=2))

        assert why(sensor_watch.warns_of_silence, run).cause_id == cause_id

    @pytest.mark.parametrize(
        ('text', 'right'),
        [
            ('1234.567 m', True),
            *[(text, True) for text in ('1,234.57', '1_234.567', '1.234,57', '1234,57 (2)')],
            *[(text, False) for text in ('1234.56', '1234.6', '-1234.57', '1,234')],
        ],
    )
    def test_number_of_a_distance_may_be_rounded_to_two_decimals(self, text, right):
        assert sensor_watch._shows(text, 1234.567) == right

    @pytest.mark.parametrize(
        ('text', 'right'),
        [
            *[(text, True) for text in ('inf m', '0000infm', '{"m": Infinity}')],
            *[(text, False) for text in ('1.25 m', 'info: 1.25 m', 'infrared: 1.25 m')],
        ],
    )
    def test_infinite_distance_may_be_shown_in_any_format(self, text, right):
        assert sensor_watch._shows(text, math.inf) == right

    def test_refusals_that_are_counted_from_the_start_are_reported(self):
        events = []
        for place, name in enumerate(sensor_watch.LAZY):
            begun = 2.0 * place
            events.append(at(begun, 'mark', name=name))
            offer = {'publisher': name, 'matched': False, 'refused': ['DEADLINE']}
            events.append(at(begun, 'offered', **offer))
            events += [logged(begun, ERROR)] * (place + 1)

        assert why(sensor_watch.names_the_policy, watched(*events)).cause_id == 'several_errors'


BEACON = publisher(
    '/beacon_signal', '/beacon', managed_beacon.TYPE, qos={'reliability': 'RELIABLE'}
)


class TestManaged:
    def test_second_configuration_that_creates_nothing_is_reported(self):
        seen = [graph(BEACON, when='configured')]
        seen += [graph(nodes=['/beacon'], when='configured again')]
        run = run_of(*seen, facts=managed_beacon.exam.facts)

        assert why(managed_beacon.cleans_up, run).cause_id == 'configured_once'

    def test_flashes_that_were_kept_are_reported(self):
        """The flashes arrive together, at the moment of the activation."""
        mark = at(1.0, 'mark', name='active')
        flashes = [message(clock, '/beacon_signal') for clock in (1.5, 1.5, 1.5, 2.5, 3.5, 4.5)]
        run = run_of(graph(BEACON), mark, *flashes, facts=managed_beacon.exam.facts)

        assert why(managed_beacon.publishes_while_active, run).cause_id == 'sent_later'

    def test_limit_that_is_rounded_in_the_line_is_reported(self):
        """The line contains a limit, so the cause is not a missing limit."""
        answer = {'data': {'results': [{'successful': True}]}}
        refused = (-1.0, 0.0, -212.45)
        facts = {'refusals': shown(refused, lambda limit: (limit,))}
        run = run_of(at(1.0, 'answer', service=managed_pressure.SETTING, **answer), facts=facts)
        for last in ('-212 is refused', 'not -2.1e+02 bar'):
            texts = ['-1 is refused', '0 is refused', last]

            found = managed_pressure._why_not_logged(run, texts, refused)

            assert found.cause_id == 'rounded_in_text'

    def test_limit_that_cleanup_loses_is_reported(self, monkeypatch):
        """The last configuration fails, because nobody set the parameter again."""
        monkeypatch.setattr(managed_pressure, '_require_warnings', lambda run, phase: None)
        seen = []
        for phase, count in (('still', 2), ('again', 3), ('highest', 5)):
            done = at(1.0, 'answer', service=managed_pressure.CHANGE, data={'success': True})
            seen += [at(1.0, 'mark', name=phase), *[done] * count]
        seen[-1] = {**seen[-1], 'data': {'success': False}}

        found = why(managed_pressure.takes_the_new_limit, run_of(*seen))

        assert found.cause_id == 'loses_the_limit'


def test_map_that_is_published_for_each_newcomer_is_reported():
    asked = replace(map_server.exam.asks['maps'], inputs=('hall', 'yard'))
    events = []
    for place, text in enumerate(asked.inputs):
        events.append(at(place + 1.0, 'input', index=place))
        events.append(message(place + 1.0, '/map', {'data': text}, after_input=place))
    again = message(9.0, '/map', {'data': 'yard'}, after_input=1)
    seen = graph(publisher('/map', '/map_server', map_server.TYPE))
    joined = at(9.0, 'joined', listener='late', matched=True, refused=[])

    run = run_of(seen, *events, joined, again, facts={'maps': asked})

    assert why(map_server.publishes_each_survey, run).cause_id == 'repeats_for_new'


@pytest.mark.parametrize(
    ('code', 'cause_id'),
    [
        ('PublisherEventCallbacks(matched=self.welcome)', 'repeats_for_new'),
        ('if self.publisher.get_subscription_count():\n    publish()', 'repeats_for_new'),
        ('self.create_timer(1.0, self.publish)', 'first_map_late'),
    ],
)
def test_first_map_for_a_newcomer_is_distinguished_from_a_late_one(code, cause_id):
    """If a map is published again for each subscription, only the last copy is stored."""
    found = closest(Code({'n.py': code}), map_server.WHY['first_map_late'])

    assert found.cause_id == cause_id


@pytest.mark.parametrize(
    ('reason', 'together', 'cause_id'),
    [('', False, 'no_reason'), ('too high', True, 'looks_at_one')],
)
def test_limit_keeper_gives_a_reason_for_each_refusal(reason, together, cause_id):
    asked = limit_keeper.exam.asks['changes']
    answers = [
        at(1.0, 'answer', service=limit_keeper.SERVICE, data={'results': [given]})
        for given in (
            {'successful': due['results.0.successful'], 'reason': reason} for due in asked.answers
        )
    ]
    service = f'{limit_keeper.NODE}/{limit_keeper.ATOMIC}'
    both = at(2.0, 'answer', service=service, data={'result': {'successful': together}})

    run = run_of(*answers, both, facts=limit_keeper.exam.facts)

    assert why(limit_keeper.gives_a_reason, run).cause_id == cause_id
