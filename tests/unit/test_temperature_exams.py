"""The exams of lesson 07, tested on handmade recordings: clocks, stamps and log lines."""

import math

from handmade_runs import at, cause_id_of, failure, message, run_of, why
import pytest

from autograder.exam.exam import Run
from autograder.exam.scenario import RosClock
from autograder.exam.specification import Specification
from autograder.judging.judge import closest
from autograder.judging.log_rows import share
from autograder.recording import ERROR, INFO, Recording, WARN
from autograder.submission.code.source_code import Code
from exams.readings import Reading, slips, warns
from exams.visible import temperature_publisher as publisher
from exams.visible import temperature_subscriber as subscriber

TIMER = 'self.create_timer(1.0, self.publish_reading)\n'
SLEEPS = f'{TIMER}def publish_reading(self):\n    time.sleep(2)'


# -- the publisher --------------------------------------------------------------------------


CLOCK = RosClock(begins_s=0.07, rate=1.25, step_s=0.1)
BEGIN_S = 0.6


def published(moments_s, code='', stamp=lambda clock_ns: CLOCK.at(clock_ns)):
    """
    Return a run of the publisher with readings at these moments.

    :param moments_s: system time [s]; the run lasts ten ROS seconds or eight system seconds
    """
    events = [at(BEGIN_S, 'mark', name='minute')]
    for moment_s in moments_s:
        sec, nanosec = divmod(stamp(round(moment_s * 1e9)), 10**9)
        data = {'timestamp': {'sec': sec, 'nanosec': nanosec}}
        events.append(message(moment_s, publisher.TOPIC, data, listener=None))
    facts = {'seconds': 10, 'clock': CLOCK}
    return run_of(*events, code=code, file='temp_publisher.py', facts=facts)


def every(ros_s, begin_s=0.8, until_s=BEGIN_S + 8.0):
    """Return system times [s] at equal intervals of the ROS clock."""
    count = math.ceil((until_s - begin_s) / ros_s * CLOCK.rate)
    return [begin_s + ros_s / CLOCK.rate * number for number in range(count)]


class TestRhythm:
    """One reading per second of the ROS clock, which runs faster than the computer's."""

    @pytest.mark.parametrize('begin_s', [0.64, 0.8, 1.3, 1.45])
    def test_second_of_the_ros_clock_is_right(self, begin_s):
        publisher.publishes_once_per_second(published(every(1.0, begin_s)))

    def test_message_may_be_a_step_late(self):
        """A loop that polls the clock notices a step of the clock only some time later."""
        late = [one + 0.07 * (number % 2) for number, one in enumerate(every(1.0))]

        publisher.publishes_once_per_second(published(late))

    @pytest.mark.parametrize(
        ('moments_s', 'cause_id', 'observed'),
        [
            (every(1.25), 'other_clock', '8 messages; first difference in second 2'),
            (every(0.5), 'wrong_rate', '20 messages; first difference in second 2'),
            (every(0.9), 'wrong_rate', '11 messages; first difference in second 3'),
            (every(0.05), 'wrong_rate', 'far more messages; first difference in second 2'),
            ([one for one in every(1.0) for _ in 'ab'], 'several_at_once', '20 messages'),
            (every(1.0, 1.6), '', '9 messages; first difference in second 1'),
            (every(1.0, until_s=6.5), 'stops', '8 messages; first difference in second 9'),
        ],
    )
    def test_other_rhythm_is_explained(self, moments_s, cause_id, observed):
        failed = failure(publisher.publishes_once_per_second, published(moments_s))

        assert (failed.why.cause_id if failed.why else '') == cause_id
        assert failed.observed.startswith(observed)

    @pytest.mark.parametrize(
        ('code', 'cause_id'),
        [
            (SLEEPS, 'sleeps_in_callback'),
            ('while True:\n    rclpy.spin_once(node, timeout_sec=1.0)', 'paced_by_spin_once'),
            (f'{TIMER}clock = Clock(clock_type=ClockType.STEADY_TIME)', 'wrong_rate'),
        ],
    )
    def test_code_tells_why_a_period_is_longer(self, code, cause_id):
        found = why(publisher.publishes_once_per_second, published(every(2.0), code))

        assert found.cause_id == cause_id


LATE = every(1.0, 1.6)


@pytest.mark.parametrize(
    ('moments_s', 'code', 'stamp', 'cause_id'),
    [
        (every(1.0), '', CLOCK.at, None),
        # The previous step is correct too, if a step and the message coincide.
        (every(1.0), '', lambda now: CLOCK.at(now) - 10**8, None),
        # The clock shows zero only before its first step.
        ([0.2, *every(1.0)], '', lambda now: CLOCK.at(now) * (now > 3 * 10**8), None),
        ([0.2, *every(1.0)], '', lambda now: CLOCK.at(now) * (now > 9 * 10**8), 'missing_stamp'),
        (every(2.0), SLEEPS, lambda now: CLOCK.at(now) - 2 * 10**9, 'sleeps_in_callback'),
        (every(1.0), '', lambda now: CLOCK.at(now - round(10**9 / CLOCK.rate)), 'prepared_stamp'),
        (LATE, '', lambda now: now, 'stale_stamp'),
        (LATE, '', lambda now: CLOCK.at(now) - 2 * 10**8, 'stale_stamp'),
        (LATE, '', lambda now: CLOCK.at(now) + 10**8, 'stale_stamp'),
        (LATE, '', lambda now: CLOCK.at(now) + 1, 'stale_stamp'),
        (LATE, '', lambda now: CLOCK.at(now) // 10**9 * 10**9, 'nanoseconds'),
        (LATE, '', lambda now: 1_790_000_000 * 10**9 + now, 'wall_clock'),
    ],
)
def test_stamp_has_to_be_the_last_step_of_the_clock(moments_s, code, stamp, cause_id):
    """Between two steps, the clock does not advance."""
    run = published(moments_s, code, stamp)

    assert cause_id_of(publisher.stamps_follow_the_clock, run) == cause_id


@pytest.mark.parametrize(('count', 'judged'), [(1, False), (2, True)])
def test_quarter_of_the_readings_is_enough_to_judge_each(count, judged):
    run = published(every(1.0)[:count])

    if judged:
        assert len(publisher.enough_readings(run)) == count
    else:
        failure(publisher.enough_readings, run)


@pytest.mark.parametrize(
    ('code', 'cause_id', 'words'),
    [
        ('timestamp = self.get_clock().now().to_msg()', 'missing_stamp', 'the field timestamp of'),
        ('# msg.timestamp = now', 'missing_stamp', 'never sets the field timestamp'),
        ('msg.timestamp = Time()', 'stale_stamp', 'is an empty Time, which is 0'),
        ('msg.timestamp = self.start', 'stale_stamp', 'before the clock ran, as in __init__.'),
        ('msg = Temperature(timestamp=self.start)', 'stale_stamp', 'never set'),
    ],
)
def test_stamp_of_zero_is_explained_by_what_the_code_does(code, cause_id, words):
    run = published(every(1.0), code, stamp=lambda _: 0)

    found = closest(Code(run.files), why(publisher.stamps_follow_the_clock, run))

    assert found.cause_id == cause_id
    assert words in found.text


# -- the subscriber -------------------------------------------------------------------------

COOL, HOT = Reading(21.5, 'a cool reading'), Reading(45.25, 'a hot reading')
WARM_F = Reading(95.0, 'a warm reading in °F', 'Fahrenheit')
NAN = Reading(math.nan, 'a reading that is not a number')
ODD = Reading(300.0, 'a reading in an unknown unit', 'QXZ')


def heard(readings, answer, code='', secret=False, printed=''):
    """Return a run of the subscriber, which logs a function's result for each reading."""
    events = []
    for number, reading in enumerate(readings):
        events.append(at(number, 'input', index=number, data=reading.message(number)))
        line = at(number, 'log', name='temperature_subscriber', after_input=number)
        events += [{**line, 'level': level, 'text': text} for level, text in answer(reading)]
    facts = {'secret': secret, 'warnings': Specification(readings, warns(), slips())}
    return run_of(*events, code=code, file='temp_subscriber.py', facts=facts, stdout=printed)


def right(reading):
    """Return the lines that the lesson requires."""
    lines = [(INFO, f'{reading.celsius:.2f}')]
    return [*lines, (WARN, 'too hot')] if reading.hot else lines


CHECKS = (
    subscriber.logs_every_reading,
    subscriber.warns_when_too_hot,
    subscriber.stays_quiet_otherwise,
)


STDERR = (
    'Traceback (most recent call last):\n'
    '  File "/submission/temp_subscriber.py", line 7, in judge\n    x\n'
    "ValueError: unknown unit 'QXZ'\n"
)
EDGE = Reading(30.0, 'a reading of exactly the limit')


def ended(readings, sent, answer):
    """Return a run in which an exception ends the program at the last reading that is sent."""
    run = heard(readings[:sent], answer)
    asked = Specification(readings, warns(), slips())
    facts = {**run.facts, 'warnings': asked}
    done = {'reason': 'student_exited', 'exit': 1, 'stderr': STDERR}
    return run_of(*run.recording.events[:-2], file='temp_subscriber.py', facts=facts, **done)


class TestEndOfTheProgram:
    """An exception explains what is missing afterwards, not what was wrong earlier."""

    def test_each_check_has_its_own_cause(self):
        run = ended([COOL, HOT, EDGE, ODD, COOL], 4, at_or_above)

        failed = failure(subscriber.logs_every_reading, run)
        assert why(subscriber.stays_quiet_otherwise, run).cause_id == 'warns_at_threshold'
        assert why(subscriber.reports_an_unknown_unit, run).cause_id == 'exception'
        assert failed.why.cause_id == 'exception'
        assert 'which was not sent, because the run had ended' in str(failed)
        assert failed.place == 4

    def test_answer_that_the_exception_cut_off_does_not_hide_the_mistake(self):
        """The hot reading at the end has no warning, because the exception came first."""
        run = ended([COOL, EDGE, HOT, COOL], 3, lambda one: at_or_above(one)[: 1 + (one is EDGE)])

        assert why(subscriber.stays_quiet_otherwise, run).cause_id == 'warns_at_threshold'
        assert why(subscriber.warns_when_too_hot, run).cause_id == 'exception'

    def test_wrong_warning_without_a_known_mistake_is_only_described(self):
        readings = [COOL, HOT, Reading(20.0, 'a cool reading'), ODD, COOL]
        run = ended(readings, 4, lambda one: [(WARN, '')] * (one.value < 21))

        assert why(subscriber.stays_quiet_otherwise, run).cause_id != 'exception'


def at_or_above(reading):
    """Return the lines of a program that also warns about the limit itself."""
    value = reading.value
    return [(INFO, f'{value:.2f}'), *[(WARN, 'hot')] * (value >= 30.0 and not reading.odd)]


OWN = '[WARN] [temperature_subscriber]: Too warm: 45.25 degC is above 30.0 degC\n'


class TestUnlogged:
    @pytest.mark.parametrize(
        ('printed', 'code', 'cause_id'),
        [
            ('', '', 'not_logged'),
            ('', 'log.debug(1)\nlog.warning(2)', 'debug_level'),
            ('21.50 Celsius\n', '', 'print_instead_of_logger'),
            ('[INFO] [mine]: 21.50 Celsius\n', '', 'other_logger'),
        ],
    )
    def test_own_warnings_are_no_printed_readings(self, printed, code, cause_id):
        """ROS also writes the log lines to standard output in this course."""
        run = heard([COOL, HOT, COOL], lambda one: right(one)[1:], code, printed=OWN + printed)

        assert why(subscriber.logs_every_reading, run).cause_id == cause_id
        assert why(subscriber.stays_quiet_otherwise, run).cause_id == cause_id

    @pytest.mark.parametrize(
        ('printed', 'code', 'cause_id'),
        [
            ('', '', 'no_warning'),
            ('', 'log.debug(1)\nlog.info(2)', 'debug_level'),
            ('WARNING: too hot\n', '', 'print_instead_of_logger'),
            ('[WARN] [mine]: too hot\n', '', 'other_logger'),
        ],
    )
    def test_warning_alone_may_be_elsewhere(self, printed, code, cause_id):
        run = heard([COOL, HOT, COOL], lambda one: right(one)[:1], code, printed=printed)

        assert why(subscriber.warns_when_too_hot, run).cause_id == cause_id

    def test_missing_warning_that_no_slip_explains_is_only_described(self):
        readings = [COOL, HOT, Reading(46.0, 'another hot reading'), HOT, COOL]
        run = heard(readings, lambda one: right(one)[: 1 + (one is HOT)])

        assert why(subscriber.warns_when_too_hot, run).cause_id == 'missed_warning'

    @pytest.mark.parametrize(
        ('printed', 'cause_id'),
        [
            ('', 'no_error'),
            ('unknown unit\n', 'print_instead_of_logger'),
            ('[ERROR] [mine]: unknown unit\n', 'other_logger'),
        ],
    )
    def test_error_that_nobody_gets_is_looked_for_where_all_is_silent(self, printed, cause_id):
        run = heard([COOL, ODD, COOL], lambda _: [], printed=printed)

        found = why(subscriber.reports_an_unknown_unit, run)

        assert found.cause_id == cause_id
        assert 'info(' not in found.try_this

    @pytest.mark.parametrize(
        ('what', 'cause_id'),
        [
            ("print('unknown', file=sys.stderr)", 'print_instead_of_logger'),
            ("print('unknown')", 'no_error'),
        ],
    )
    def test_error_that_goes_to_stderr_is_no_log(self, what, cause_id):
        """The grader searches only stdout, so the code must show this cause."""
        code = f"node.create_subscription(T, 't', hear, 10)\ndef hear(msg):\n    {what}\n"
        run = heard([COOL, ODD, COOL], lambda one: right(one)[:1] if one is COOL else [], code)

        found = why(subscriber.reports_an_unknown_unit, run)

        assert closest(Code(run.files), found).cause_id == cause_id


class TestErrors:
    @pytest.mark.parametrize('check', CHECKS)
    @pytest.mark.parametrize(
        ('text', 'cause_id', 'words'),
        [
            (
                "went wrong: 'Temperature' object has no attribute 'temperature'",
                'no_field',
                'The type Temperature has no field temperature',
            ),
            (
                "something: name 'limit' is not defined",
                'logged_error',
                "logs this error: 'something: name 'limit' is not defined'",
            ),
            ("unsupported operand type(s) for -: 'str'", 'logged_error', 'unsupported operand'),
            ('nicht lesbar', 'logged_error', "'nicht lesbar'"),
            ('unknown unit Celsius', 'unit_text', 'as if their unit were unknown'),
            ('Celsius ist unbekannt', 'unit_text', 'as if their unit were unknown'),
        ],
    )
    def test_text_of_the_error_is_reported_and_no_unit_invented(
        self, check, text, cause_id, words
    ):
        found = why(check, heard([COOL, HOT, COOL], lambda _: [(ERROR, text)]))

        assert found.cause_id == cause_id
        assert words in found.text

    def test_readings_that_are_all_logged_as_errors_have_the_wrong_level(self):
        run = heard([COOL, HOT], lambda reading: [(ERROR, f'{reading.value} Celsius')])

        assert why(subscriber.logs_every_reading, run).cause_id == 'wrong_level'
        assert why(subscriber.warns_when_too_hot, run).cause_id == 'wrong_level'

    def test_line_of_a_hidden_exam_is_quoted_without_what_was_sent(self):
        text = "bad 21.5, heard 45.25 and qxz, name 'x' is not defined " + 'long ' * 99

        found = why(CHECKS[0], heard([COOL, HOT, ODD], lambda _: [(ERROR, text)], secret=True))

        assert "'bad …, heard … and …, name 'x' is not defined" in found.text
        assert len(found.text) < 200

    def test_name_of_an_attribute_carries_nothing_out_of_a_hidden_exam(self):
        """A student might log such a line on purpose to learn a hidden value."""
        text = "'N' object has no attribute 'v4525'"

        found = why(CHECKS[0], heard([COOL], lambda _: [(ERROR, text)], secret=True))

        assert found.cause_id == 'logged_error'
        assert '4525' not in found.text


class TestFahrenheit:
    @staticmethod
    def refusing(code, text='unknown unit'):
        """Return a run of a node that does not know Fahrenheit."""
        return heard(
            [COOL, HOT, WARM_F, COOL],
            lambda one: [(ERROR, text)] if one.unit == 'Fahrenheit' else right(one),
            code,
        )

    @pytest.mark.parametrize('check', [subscriber.converts_fahrenheit, CHECKS[0]])
    @pytest.mark.parametrize(
        ('code', 'hint'),
        [
            ("elif msg.unit == 'Farenheit':", "Your code has 'Farenheit'"),
            ("if msg.unit == 'F': pass", 'Add a branch for exactly this word'),
            ("if msg.unit == 'Farenheit': pass", "Your code has 'Farenheit'"),
            ("if msg.unit != 'Celsius': error()", 'Add a branch for exactly this word'),
            ("if msg.unit.lower() == 'Fahrenheit': pass", 'Add a branch for exactly this word'),
        ],
    )
    def test_no_other_level_is_advised(self, check, code, hint):
        """If the node logged a warning instead, the check of unknown units would fail."""
        if code.startswith('elif'):
            code = f"if msg.unit == 'Celsius':\n    pass\n{code}\n    pass\n"

        found = why(check, self.refusing(code))

        assert found.cause_id == 'fahrenheit_refused'
        assert 'as if their unit were unknown' in found.text
        assert hint in found.try_this
        assert 'warning' not in found.try_this

    def test_wrong_conversion_is_no_wrong_comparison(self):
        run = heard([COOL, HOT, WARM_F, COOL], lambda one: right(one)[: 1 + (one is HOT)])

        found = why(subscriber.converts_fahrenheit, run)

        assert found.cause_id == 'wrong_conversion'
        assert '86 °F must give 30' in found.try_this

    def test_comparison_that_is_wrong_in_celsius_too_is_blamed_for_both(self):
        run = heard([HOT, HOT, WARM_F, COOL], right)
        first, *others = run.recording.logs(level=WARN)
        events = [event for event in run.recording.events if event not in others]
        run = Run(run.files, Recording({}, events), run.facts)

        assert first in events
        assert why(subscriber.converts_fahrenheit, run).cause_id == 'warns_once'

    def test_mistake_in_the_conversion_is_quoted(self):
        run = self.refusing('', "unsupported operand type(s) for -: 'str' and 'int'")

        assert why(subscriber.converts_fahrenheit, run).cause_id == 'logged_error'


def test_warning_of_nan_is_no_wrong_comparison_elsewhere():
    run = heard([COOL, NAN, HOT], lambda one: [(WARN, 'oh')] if one.odd else right(one))

    assert why(subscriber.does_not_warn_about_nan, run).cause_id == 'nan'


@pytest.mark.parametrize(('reason', 'part'), [('student_exited', 0.5), ('cpu_limit', 0.0)])
def test_how_far_a_slow_program_came_earns_nothing(reason, part):
    """Progress counts only if the program ended by itself, not at a limit of the grader."""
    run = Run({}, Recording({}, ({'event': 'end', 'reason': reason},)))

    assert share(run, [[], None], 1, 2) == part
