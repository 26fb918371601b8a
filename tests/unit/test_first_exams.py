"""The exams of lessons 01 and 03, asked about recordings made by hand: rhythm, count and level."""

from __future__ import annotations

from itertools import count

import pytest

from autograder.exams.visible import courier, harbour, night_watch, running_mean, talker
from autograder.judging.exam import Failed, Run
from autograder.runs.recording import ERROR, INFO, Recording, WARN

SECONDS = 11
DEPTH_10 = {'reliability': 'RELIABLE', 'durability': 'VOLATILE'}
SERVED = [{'event': 'barrier', 'node': '/n/night_watch', 'answered': True}]
RUNS = [{'event': 'end', 'reason': 'complete'}, {'event': 'process'}]
FIRST = ({'event': 'mark', 'name': 'first'}, {'event': 'joined', 'listener': 'first'})
SECOND = ({'event': 'mark', 'name': 'second'}, {'event': 'joined', 'listener': 'second'})
PARCEL = {'event': 'message', 'topic': courier.TOPIC, 'listener': 'first', 'data': {}}


def log(clock_s, text, level=INFO, name='n.night_watch'):
    """Return a log line; None for one of before the clock."""
    clock_ns = None if clock_s is None else round(clock_s * 1e9)
    return {'event': 'log', 'clock_ns': clock_ns, 'name': name, 'level': level, 'text': text}


def night(*lines, code='create_timer(1.0, self.report)', printed=''):
    """Return a run of the night watch with these lines, one a second; None is silence."""
    events = [log(1.1 + second, *line) for second, line in enumerate(lines) if line]
    facts = {'namespace': '/n', 'simulated_s': SECONDS}
    ends = (RUNS[0], {**RUNS[1], 'stdout': printed})
    return Run({'n.py': code}, Recording({}, (*SERVED, *events, *ends)), facts)


def watches(level=lambda number: INFO if number % 5 else WARN, text='watch {}', first=1, step=1):
    """Return the lines of a night."""
    numbers = [first + step * place for place in range(SECONDS)]
    return [(text.format(one), level(place)) for place, one in enumerate(numbers, 1)]


def cause_of(check, run):
    """Return the cause for which a check fails."""
    with pytest.raises(Failed) as failed:
        check(run)
    return failed.value.why and failed.value.why.cause_id


class TestNightWatch:
    """Lines of a night: one a second, numbered, every fifth a warning."""

    @pytest.mark.parametrize('text', ['watch {}', '{:03d}', '{} of 99', 'watch={}.0'])
    def test_any_form_of_the_number_passes(self, text):
        """A number is a number, with zeros in front or another one beside it."""
        run = night(*watches(text=text))

        night_watch.reports_every_second(run)
        night_watch.lines_are_numbered(run)
        night_watch.every_fifth_is_a_warning(run)

    @pytest.mark.parametrize(('served', 'cause_id'), [(False, 'own_loop'), (True, 'other_clock')])
    def test_loop_may_have_spoken_before_anybody_heard_it(self, served, cause_id):
        """Its first number counts, and which of its lines are fifths follows from that."""
        lines = watches(level=lambda place: WARN if place % 5 == 3 else INFO, first=3)
        run = night(*lines[:6])
        seen = [one for one in run.recording.events if served or one not in SERVED]
        alone = [{'event': 'other_clock', 'sources': ['n.night_watch']}] if served else []
        events = (*alone, {'event': 'wall_time', 'seconds': 6.0}, *seen)
        real = Run(run.files, Recording({}, events), run.facts)

        night_watch.lines_are_numbered(real)
        night_watch.every_fifth_is_a_warning(real)
        assert cause_of(night_watch.reports_every_second, real) == cause_id
        assert cause_of(night_watch.lines_are_numbered, night(*lines)) is None

    @pytest.mark.parametrize(
        ('argument', 'cause_id'),
        [('', 'lines_missing'), (', throttle_duration_sec=2.0', 'left_out')],
    )
    def test_logger_that_leaves_lines_out_is_told(self, argument, cause_id):
        """One line has no rate; and no timer is blamed that has the right period."""
        code = f'create_timer(1.0, tick)\ndef tick():\n    log.info(number{argument})\n'
        run = night(watches()[0], code=code)

        assert cause_of(night_watch.reports_every_second, run) == cause_id

    def test_line_of_the_start_is_no_watch(self):
        """Many nodes say that they have started, before there is a clock."""
        run = night(*watches())
        start = log(None, 'Night watch 7 has been started')
        run = Run(run.files, Recording({}, (start, *run.recording.events)), run.facts)

        night_watch.reports_every_second(run)
        night_watch.lines_are_numbered(run)
        night_watch.every_fifth_is_a_warning(run)

    @pytest.mark.parametrize(
        ('lines', 'cause_id'),
        [
            (watches(text='all quiet'), 'no_number'),
            (watches(text='watch {{self.number}}'), 'no_f_string'),
            (watches(step=2), 'wrong_step'),
            (watches(first=0), 'counts_from_zero'),
            (watches(first=2), 'counted_before'),
            (watches(first=7), None),
            (watches(step=0), 'never_counts'),
        ],
    )
    def test_wrong_number_is_explained(self, lines, cause_id):
        """Each way to count wrongly has a name of its own."""
        assert cause_of(night_watch.lines_are_numbered, night(*lines)) == cause_id

    @pytest.mark.parametrize(
        ('level', 'cause_id'),
        [
            (lambda number: INFO if number % 5 else ERROR, 'wrong_level'),
            (lambda number: INFO, 'no_warning'),
            (lambda number: WARN, 'warns_otherwise'),
            (lambda number: INFO if number % 4 else WARN, 'warns_otherwise'),
            (lambda number: WARN if number == 5 else INFO, 'warns_once'),
            (lambda number: WARN if number > 4 else INFO, 'warns_too_often'),
            (lambda number: WARN if number % 5 else INFO, 'inverted'),
            (lambda number: WARN if number % 5 == 4 else INFO, 'warns_one_early'),
            (lambda number: WARN if number % 5 == 1 and number > 1 else INFO, 'warns_one_late'),
        ],
    )
    def test_wrong_level_is_explained(self, level, cause_id):
        """Each way to warn wrongly has a name of its own."""
        run = night(*watches(level))

        assert cause_of(night_watch.every_fifth_is_a_warning, run) == cause_id

    def test_fifth_watch_that_is_left_out_is_told_everywhere(self):
        """All later lines are shifted by it, so no other cause would be true."""
        run = night(*watches()[:4], *watches()[5:9], *watches()[10:])

        assert cause_of(night_watch.reports_every_second, run) == 'fifth_missing'
        assert cause_of(night_watch.lines_are_numbered, run) == 'fifth_missing'

    @pytest.mark.parametrize(
        ('form', 'code', 'cause_id'),
        [
            ('', '', 'fifth_missing'),
            ('{}: ready\n', '', 'fifth_missing'),
            ('Watch {}\n', '', 'print_instead_of_logger'),
            ('[WARN] [mine]: Watch {}\n', '', 'other_logger'),
            ('', 'log.debug(1)', 'debug_level'),
        ],
    )
    def test_fifth_watch_that_is_elsewhere_is_not_called_missing(self, form, code, cause_id):
        """Printed, dropped or said by another logger: what it lacks is not an else."""
        lines = [line if number % 5 else None for number, line in enumerate(watches(), 1)]
        numbers = (1, 2) if 'ready' in form else (5, 10)
        run = night(*lines, code=code, printed=''.join(map(form.format, numbers)))

        assert cause_of(night_watch.reports_every_second, run) == cause_id

    @pytest.mark.parametrize(
        ('form', 'code', 'cause_id'),
        [
            ('', '', 'only_fifths'),
            ('Watch {}\n', '', 'print_instead_of_logger'),
            ('[INFO] [mine]: Watch {}\n', '', 'other_logger'),
            ('', 'log.debug(1)', 'debug_level'),
        ],
    )
    def test_period_is_not_blamed_where_only_the_fifths_are_logged(self, form, code, cause_id):
        """Their numbers show that the others were counted."""
        lines = [None if number % 5 else line for number, line in enumerate(watches(), 1)]
        run = night(*lines, code=code, printed=''.join(map(form.format, (1, 2, 3, 4))))

        assert cause_of(night_watch.reports_every_second, run) == cause_id
        assert cause_of(night_watch.lines_are_numbered, run) == cause_id

    def test_right_period_is_not_advised_again(self):
        """Every other call says nothing, or every other second has no call."""
        other = [line if number % 2 else None for number, line in enumerate(watches(), 1)]
        right, wrong = 'self.create_timer(1.0, f)', 'self.create_timer(2.0, f)'
        check = night_watch.reports_every_second

        assert cause_of(check, night(*other, code=right)) == 'lines_missing'
        assert cause_of(check, night(*other, code=wrong)) == 'wrong_rate'

    def test_flood_of_lines_is_told_without_a_count(self):
        """How many of them arrive is luck."""
        run = night(*watches() * 11)

        assert cause_of(night_watch.reports_every_second, run) == 'flood'


class TestHarbour:
    """Reports of one node, once a period."""

    @staticmethod
    def keeper(*moments, code='create_timer(2.0, self.report)'):
        """Return a run in which the keeper reports at these moments [s]."""
        barrier = {'event': 'barrier', 'node': harbour.KEEPER, 'answered': True}
        lines = [log(moment, 'light on', name='harbour.keeper') for moment in moments]
        return Run(
            {'harbour.py': code}, Recording({}, (barrier, *lines, *RUNS)), {'simulated_s': 8}
        )

    @pytest.mark.parametrize('moments', [(2.1, 4.1, 6.1, 8.1), (1.1, 3.1, 5.1, 7.1)])
    def test_it_does_not_matter_in_which_second_the_rhythm_begins(self, moments):
        """One line every two seconds is what is asked for."""
        harbour.keeper_reports_every_two_seconds(self.keeper(None, *moments))

    @pytest.mark.parametrize(
        ('moments', 'code', 'cause_id'),
        [
            ((), 'self.report()', 'no_timer'),
            ((), 'create_timer(2.0, f); log.debug(1)', 'debug_level'),
            ((), 'create_timer(2.0, f)\ntry: pass\nexcept: pass', 'swallowed'),
            ((), 'create_timer(2.0, f)', 'silent'),
            ((2.1, 6.1), '', 'wrong_rate'),
            ((2.1, 2.1, 4.1, 4.1, 6.1, 6.1, 8.1, 8.1), '', 'several_at_once'),
            ((3.1, 4.1, 6.1, 8.1), '', None),
        ],
    )
    def test_other_rhythm_is_explained(self, moments, code, cause_id):
        """What the text of the program says helps to explain silence."""
        run = self.keeper(*moments, code=code)

        assert cause_of(harbour.keeper_reports_every_two_seconds, run) == cause_id


class TestTalker:
    """What the greetings say."""

    @pytest.mark.parametrize(
        ('texts', 'cause_id'),
        [
            ([f'hello {number}' for number in range(2, 9)], 'begins_later'),
            ([f'hello {number}' for number in range(7)], 'counts_from_zero'),
            ([f'hello {number}' for number in range(1, 15, 2)], 'wrong_step'),
            ([f'hello {number // 2}' for number in range(2, 16)], 'wrong_step'),
            (['hello 1'] * 7, 'never_counts'),
            (['hello {self.count}'] * 7, 'no_f_string'),
            ([f'hello{number}' for number in range(1, 8)], 'wrong_text'),
            (['hello 1'], 'wrong_rate'),
        ],
    )
    def test_wrong_text_is_explained(self, texts, cause_id):
        """Each way to count wrongly has a name of its own."""
        end = {'topic': '/lab/chatter', 'kind': 'publisher', 'node': '/lab/talker'}
        graph = {'event': 'graph', 'nodes': [], 'endpoints': [end]}
        said = [
            {
                'event': 'message',
                'topic': '/lab/chatter',
                'clock_ns': clock,
                'data': {'data': text},
            }
            for text, clock in zip(texts, count(10**9), strict=False)
        ]
        run = Run({}, Recording({}, (graph, *said, *RUNS)), {'space': '/lab', 'seconds': 6.0})

        assert cause_of(talker.counts_its_greetings, run) == cause_id


class TestCourier:
    """When the parcel comes, and to whom."""

    @staticmethod
    def run_of(*events, durability='VOLATILE', code='', reason='complete', **process):
        """Return a run of the courier."""
        end = {
            'topic': courier.TOPIC,
            'kind': 'publisher',
            'node': courier.NODE,
            'type': courier.TYPE,
            'qos': {**DEPTH_10, 'durability': durability},
        }
        events = (
            {'event': 'graph', 'nodes': [courier.NODE], 'endpoints': [end]},
            *events,
            {'event': 'end', 'reason': reason},
            {'event': 'process', **process},
        )
        return Run({'courier.py': code}, Recording({}, events))

    def test_parcel_that_comes_with_the_second_listener_is_late(self):
        """As soon as a subscription is connected, says the exercise."""
        run = self.run_of(*FIRST, *SECOND, PARCEL)

        assert cause_of(courier.delivers_to_who_comes_late, run) == 'waits_for_two'

    @pytest.mark.parametrize(
        ('code', 'cause_id'),
        [
            ('create_timer(1.0, f); get_subscription_count()', 'never_publishes'),
            ('if p.get_subscription_count(): p.publish(m)', 'published_too_early'),
            ('create_timer(1.0, f); get_subscription_count(); p.publish(m)', 'looks_wrong'),
            ('create_timer(1.0, f); p.publish(m)', 'published_too_early'),
        ],
    )
    def test_silence_is_explained_by_the_text(self, code, cause_id):
        """A program that looks for listeners is not told to look for listeners."""
        run = self.run_of(*FIRST, *SECOND, code=code)

        assert cause_of(courier.delivers_to_who_comes_late, run) == cause_id

    def test_parcel_that_is_kept_is_delivered_again(self):
        """Whoever asks for old messages gets it, at any time."""
        run = self.run_of(*FIRST, PARCEL, *SECOND, durability='TRANSIENT_LOCAL')

        courier.delivers_to_who_comes_late(run)
        assert cause_of(courier.delivers_once, run) == 'qos_durability'


class TestRunningMean:
    """Which mean it is instead."""

    @pytest.mark.parametrize(
        ('answers', 'cause_id'),
        [
            ([4.0, 8.0, -2.5, 11.0], 'passes_on'),
            ([4.0, 12.0, 9.5, 20.5], 'sum'),
            ([2.0, 4.0, 9.5 / 4, 4.1], 'wrong_count'),
            ([4.0, 6.0, 3.17, 5.12], 'rounded'),
            ([4.0, 6.0, 3.0, 5.0], 'cut_off'),
            ([4.0, 6.0, 2.75, 4.25], 'last_two'),
            ([0.0, 4.0, 6.0, 9.5 / 3], 'one_behind'),
            ([1.0, 2.0, 3.0, 4.0], None),
        ],
    )
    def test_wrong_mean_is_explained(self, answers, cause_id):
        """Only what fits each answer is named."""
        events = [
            {'event': 'message', 'topic': '/mean', 'after_input': place, 'data': {'data': answer}}
            for place, answer in enumerate(answers)
        ]
        run = Run({}, Recording({}, (*events, *RUNS)), running_mean.exam.facts)

        assert cause_of(running_mean.publishes_the_mean, run) == cause_id

    def test_two_topics_that_changed_places_are_named_together(self):
        """The name of neither is wrong."""
        ends = [
            {'topic': topic, 'kind': kind, 'node': '/running_mean', 'type': running_mean.TYPE}
            for topic, kind in (('/mean', 'subscription'), ('/readings', 'publisher'))
        ]
        graph = {'event': 'graph', 'nodes': ['/running_mean'], 'endpoints': ends}

        run = Run({}, Recording({}, (graph, *RUNS)), running_mean.exam.facts)

        assert cause_of(running_mean.reads_and_writes, run) == 'swapped'
