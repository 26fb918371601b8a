"""The exams of lessons 01 and 03, tested on handmade recordings: rhythm, count and level."""

import pytest

from autograder.exam.exam import Failed, Run
from autograder.judging.judge import closest
from autograder.recording import ERROR, INFO, Recording, WARN
from autograder.submission.code.source_code import Code
from exams.visible import courier, harbour, night_watch, running_mean, talker

SECONDS = 21
DEPTH_10 = {'reliability': 'RELIABLE', 'durability': 'VOLATILE'}
WATCHED = {'event': 'mark', 'name': harbour.WATCH, 'clock_ns': 550_000_000}
RUNS = [{'event': 'end', 'reason': 'complete'}, {'event': 'process'}]


def log(clock_s, text, level=INFO, name='n.night_watch'):
    clock_ns = round(clock_s * 1e9)
    return {'event': 'log', 'clock_ns': clock_ns, 'name': name, 'level': level, 'text': text}


def night(*lines, code='create_timer(1.0, self.report)', printed='', start=()):
    """
    Return a run of the night watch with these lines, one per second; None is silence.

    :param start: texts that the watch logs when it starts
    """
    before = [log(0.1, text) for text in start]
    events = [log(1.0 + second, *line) for second, line in enumerate(lines) if line]
    facts = night_watch.build(SECONDS, '/n').facts
    ends = (RUNS[0], {**RUNS[1], 'stdout': printed})
    return Run({'n.py': code}, Recording({}, (*before, WATCHED, *events, *ends)), facts)


def watches(level=lambda number: INFO if number % 5 else WARN, text='watch {}', first=1, step=1):
    numbers = [first + step * place for place in range(SECONDS)]
    return [(text.format(one), level(place)) for place, one in enumerate(numbers, 1)]


def cause_of(check, run):
    """Return the id of the cause for which a check fails."""
    with pytest.raises(Failed) as failed:
        check(run)
    return failed.value.why and failed.value.why.cause_id


def passes(run):
    """Call each check of the night watch, which raises nothing."""
    night_watch.reports_every_second(run)
    night_watch.lines_are_numbered(run)
    night_watch.every_fifth_is_a_warning(run)


class TestNightWatch:
    """The lines of a night: one per second, numbered, and every fifth one a warning."""

    @pytest.mark.parametrize('text', ['watch {}', '{:03d}', '{} of 99', 'watch={}.0'])
    def test_any_form_of_the_number_passes(self, text):
        """The number may have leading zeros, or a second number next to it."""
        passes(night(*watches(text=text)))

    @pytest.mark.parametrize(
        ('argument', 'cause_id'),
        [('', None), (', throttle_duration_sec=2.0', 'left_out')],
    )
    def test_logger_that_leaves_lines_out_is_reported(self, argument, cause_id):
        """A single line shows no rate, and a timer with the correct period is not blamed."""
        code = f'create_timer(1.0, tick)\ndef tick():\n    log.info(number{argument})\n'
        run = night(watches()[0], code=code)

        assert cause_of(night_watch.reports_every_second, run) == cause_id

    @pytest.mark.parametrize(
        ('start', 'first'),
        [
            (['Night watch 7 has been started'], 1),
            (['watch 1'], 2),
            (['Night watch 7 has been started', 'watch 1'], 2),
        ],
    )
    def test_line_of_the_start_may_be_the_first_watch(self, start, first):
        """Many nodes first log that they have started; some log watch 1 at once."""
        levels = watches(
            level=lambda place: INFO if (place + first - 1) % 5 else WARN, first=first
        )
        passes(night(*levels, start=start))

    @pytest.mark.parametrize(
        ('lines', 'cause_id'),
        [
            (watches(text='all quiet'), 'no_number'),
            (watches(text='watch {{self.number}}'), 'no_f_string'),
            (watches(step=2), 'wrong_step'),
            (watches(first=0), 'counts_from_zero'),
            (watches(first=2), 'begins_later'),
            (watches(first=7), 'begins_later'),
            (watches(step=0), 'never_counts'),
        ],
    )
    def test_wrong_number_is_explained(self, lines, cause_id):
        assert cause_of(night_watch.lines_are_numbered, night(*lines)) == cause_id

    @pytest.mark.parametrize(
        ('level', 'cause_id'),
        [
            (lambda number: INFO if number % 5 else ERROR, 'wrong_level'),
            (lambda number: INFO, 'no_warning'),
            (lambda number: WARN, 'warns_otherwise'),
            (lambda number: INFO if number % 4 else WARN, 'warns_otherwise'),
            (lambda number: WARN if number == 5 else INFO, 'warns_otherwise'),
            (lambda number: WARN if number > 4 else INFO, 'warns_too_often'),
            (lambda number: WARN if number % 5 else INFO, 'inverted'),
            (lambda number: WARN if number % 5 == 4 else INFO, 'warns_one_early'),
            (lambda number: WARN if number % 5 == 1 and number > 1 else INFO, 'warns_one_late'),
        ],
    )
    def test_wrong_level_is_explained(self, level, cause_id):
        assert cause_of(night_watch.every_fifth_is_a_warning, night(*watches(level))) == cause_id

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
        """If the line was printed, dropped or sent by another logger, no ``else`` is missing."""
        lines = [line if number % 5 else None for number, line in enumerate(watches(), 1)]
        numbers = (1, 2) if 'ready' in form else (5, 10)
        run = night(*lines, code=code, printed=''.join(map(form.format, numbers)))

        assert cause_of(night_watch.reports_every_second, run) == cause_id
        if not form and not code:  # The missing line shifts all later lines.
            assert cause_of(night_watch.lines_are_numbered, run) == cause_id

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
        """The numbers of the warnings show that the node counted the other lines."""
        lines = [None if number % 5 else line for number, line in enumerate(watches(), 1)]
        run = night(*lines, code=code, printed=''.join(map(form.format, (1, 2, 3, 4))))

        assert cause_of(night_watch.reports_every_second, run) == cause_id
        assert cause_of(night_watch.lines_are_numbered, run) == cause_id

    @pytest.mark.parametrize(
        ('logged', 'cause_id'),
        [
            (lambda number: number % 2, 'wrong_rate'),
            (lambda number: number not in (4, 9), 'some_missing'),
        ],
    )
    def test_rate_that_is_even_is_reported_and_one_with_holes_is_not(self, logged, cause_id):
        lines = [line if logged(number) else None for number, line in enumerate(watches(), 1)]

        assert cause_of(night_watch.reports_every_second, night(*lines)) == cause_id


class TestHarbour:
    @staticmethod
    def keeper(*moments, code='create_timer(2.0, self.report)', warned=()):
        """Return a run in which the keeper reports, or logs a warning, at these times [s]."""
        lines = [log(moment, 'light on', name='harbour.keeper') for moment in moments]
        lines += [log(moment, 'a ship', WARN, 'harbour.keeper') for moment in warned]
        lines.sort(key=lambda line: line['clock_ns'])
        events = (log(0.1, 'I begin', name='harbour.keeper'), WATCHED, *lines, *RUNS)
        return Run({'harbour.py': code}, Recording({}, events), {'seconds': 8})

    @pytest.mark.parametrize('moments', [(2.0, 4.0, 6.0, 8.0), (1.1, 3.1, 5.1, 7.1)])
    def test_it_does_not_matter_in_which_second_the_rhythm_begins(self, moments):
        """The exercise requires one line every two seconds, from any moment on."""
        harbour.keeper_reports_every_two_seconds(self.keeper(*moments))

    @pytest.mark.parametrize(
        ('moments', 'code', 'cause_id'),
        [
            ((), 'self.report()', 'no_timer'),
            ((), 'create_timer(2.0, f); log.debug(1)', 'debug_level'),
            ((), 'create_timer(2.0, f)\ntry: pass\nexcept: pass', 'swallowed'),
            ((), 'create_timer(2.0, f)', 'silent'),
            ((4.0, 8.0, 12.0), '', 'wrong_rate'),
            ((2.1, 2.1, 4.1, 4.1, 6.1, 6.1, 8.1, 8.1), '', 'several_at_once'),
            ((1.1, 2.1, 2.1, 3.1, 4.1, 4.1, 5.1, 6.1, 6.1, 7.1, 8.1, 8.1), '', 'other_node_logs'),
            ((2.1, 4.1, 6.1, 7.1, 8.1, 9.1), '', 'changes_rhythm'),
            ((3.1, 4.1, 6.1, 8.1), '', None),
        ],
    )
    def test_other_rhythm_is_explained(self, moments, code, cause_id):
        run = self.keeper(*moments, code=code)

        assert cause_of(harbour.keeper_reports_every_two_seconds, run) == cause_id

    @pytest.mark.parametrize(
        ('warned', 'cause_id'), [((4.1,), 'wrong_level'), ((2.2, 6.2, 8.2), 'some_missing')]
    )
    def test_line_of_another_level_explains_only_the_line_that_it_replaces(self, warned, cause_id):
        run = self.keeper(2.1, 6.1, 8.1, warned=warned)

        assert cause_of(harbour.keeper_reports_every_two_seconds, run) == cause_id


SLEEPS = 'def speak(self):\n    time.sleep(2.0)\n'


class TestTalker:
    @staticmethod
    def run_of(texts, lost=0, period_s=0.5, code=''):
        """Return a run in which these greetings are received, and the earlier ones are lost."""
        end = {'topic': '/lab/chatter', 'kind': 'publisher', 'node': '/lab/talker'}
        graph = {'event': 'graph', 'nodes': [], 'endpoints': [end]}
        said = [
            {
                'event': 'message',
                'topic': '/lab/chatter',
                'clock_ns': round(number * period_s * 1e9),
                'data': {'data': text},
                'number': number,
            }
            for number, text in enumerate(texts, lost + 1)
        ]
        facts = {'node': '/lab/talker', 'topic': '/lab/chatter', 'seconds': 6.0}
        return Run({'talker.py': code}, Recording({}, (graph, *said, *RUNS)), facts)

    @pytest.mark.parametrize(
        ('texts', 'cause_id'),
        [
            ([f'hello {number}' for number in range(2, 9)], 'begins_later'),
            ([f'hello {number}' for number in range(7)], 'counts_from_zero'),
            ([f'hello {number}' for number in range(1, 15, 2)], 'wrong_step'),
            ([f'hello {number // 2}' for number in range(2, 16)], 'same_number'),
            (['hello 1'] * 7, 'never_counts'),
            (['hello {self.count}'] * 7, 'no_f_string'),
            ([f'hello{number}' for number in range(1, 8)], 'wrong_text'),
            (['hello 1'], 'wrong_rate'),
        ],
    )
    def test_wrong_text_is_explained(self, texts, cause_id):
        assert cause_of(talker.counts_its_greetings, self.run_of(texts)) == cause_id

    def test_greeting_that_nobody_could_hear_counts(self):
        """A loop publishes hello 1 at once, and the number of the next message shows this."""
        talker.counts_its_greetings(self.run_of([f'hello {one}' for one in range(2, 9)], lost=1))

        run = self.run_of([f'hello {one}' for one in range(1, 8)], lost=1)
        assert cause_of(talker.counts_its_greetings, run) == 'counts_from_zero'

    @pytest.mark.parametrize(
        ('period_s', 'code', 'cause_id'),
        [
            (1.0, '', 'wrong_rate'),
            (0.0, '', 'several_at_once'),
            (0.45, '', 'wrong_rate'),
            (2.0, SLEEPS, 'wrong_rate'),
            (2.0, f'self.create_timer(0.5, self.speak)\n{SLEEPS}', 'sleeps_in_callback'),
        ],
    )
    def test_wrong_rate_is_explained(self, period_s, code, cause_id):
        """Equal gaps show the period; a callback that sleeps explains a longer period."""
        run = self.run_of([''] * round(6.0 / (period_s or 0.25)), period_s=period_s, code=code)

        assert cause_of(talker.speaks_twice_a_second, run) == cause_id


class TestCourier:
    @staticmethod
    def run_of(
        *heard, code='', lost=0, lives=('delivered', 'end'), durability='VOLATILE', exit=None
    ):
        """
        Return a run of the courier.

        :param heard: phase and subscription of each parcel
        :param lost: number of parcels that were sent earlier, without a subscription
        :param lives: the graphs that contain the courier's publisher
        """
        end = {'topic': courier.TOPIC, 'kind': 'publisher', 'node': courier.NODE}
        end |= {'type': courier.TYPE, 'qos': {**DEPTH_10, 'durability': durability}}
        graph = {'event': 'graph', 'nodes': [courier.NODE], 'endpoints': [end]}
        parcel = {'event': 'message', 'topic': courier.TOPIC, 'data': {'data': courier.TEXT}}
        events = []
        for place, phase in enumerate(('first', 'second', 'third')):
            happened = [{'event': 'mark', 'name': phase}, {'event': 'joined', 'listener': phase}]
            happened += [
                {**parcel, 'listener': listener, 'number': lost + 1}
                for when, listener in heard
                if when == phase
            ]
            events += [{**one, 'clock_ns': place * 10**10} for one in happened]
        graphs = [{**graph, 'when': when} for when in ('start', *lives)]
        ended = {'event': 'end', 'reason': 'complete' if exit is None else 'student_exited'}
        process = {'event': 'process', 'exit': exit}
        return Run({'courier.py': code}, Recording({}, (*graphs, *events, ended, process)))

    def test_parcel_that_comes_with_the_second_listener_is_late(self):
        """The exercise requires the parcel as soon as the first subscription is connected."""
        run = self.run_of(('second', 'first'))

        assert cause_of(courier.delivers_to_who_comes_late, run) == 'waits_for_two'

    @pytest.mark.parametrize(
        ('code', 'cause_id'),
        [
            ('create_timer(1.0, f); get_subscription_count()', 'never_publishes'),
            ('if p.get_subscription_count(): p.publish(m)', 'published_too_early'),
            ('create_timer(1.0, f); get_subscription_count(); p.publish(m)', 'looks_wrong'),
            ('create_timer(1.0, f); p.publish(m)', 'published_too_early'),
            (
                'create_timer(1.0, f); p.publish(m)\n'
                'for _ in range(300): p.get_subscription_count()\n',
                'gives_up',
            ),
            (
                'create_timer(1.0, f); p.publish(m); get_subscription_count()\n'
                'looks += 1\nif looks > 99: t.cancel()\n',
                'gives_up',
            ),
        ],
    )
    def test_silence_is_explained_by_the_text(self, code, cause_id):
        """A program that already looks for subscriptions is not told to look for them."""
        run = self.run_of(code=code)

        with pytest.raises(Failed) as failed:
            courier.delivers_to_who_comes_late(run)

        assert closest(Code(run.files), failed.value.why).cause_id == cause_id

    def test_parcel_that_is_kept_is_delivered_again(self):
        """A subscription that requests old messages gets the parcel at any time."""
        run = self.run_of(('first', 'first'), durability='TRANSIENT_LOCAL')

        courier.delivers_to_who_comes_late(run)
        assert cause_of(courier.delivers_once, run) == 'qos_durability'

    @pytest.mark.parametrize(
        ('heard', 'cause_id'),
        [
            ([('first', 'first')] * 2, 'several_at_once'),
            ([('first', 'first'), ('second', 'first'), ('second', 'second')], 'delivers_again'),
            ([('first', 'first'), ('third', 'second')], 'delivers_again'),
            ([('first', 'first'), ('third', 'third')], 'delivers_again'),
        ],
    )
    def test_second_parcel_is_explained(self, heard, cause_id):
        assert cause_of(courier.delivers_once, self.run_of(*heard)) == cause_id

    def test_parcel_that_nobody_could_receive_counts(self):
        """The number of a message shows how many messages its publisher has sent earlier."""
        courier.delivers_once(self.run_of(('first', 'first')))

        early = self.run_of(('first', 'first'), lost=1)
        assert cause_of(courier.delivers_once, early) == 'published_too_early'

    @pytest.mark.parametrize(('exit', 'cause_id'), [(None, 'destroyed'), (0, 'exited_early')])
    def test_node_that_goes_after_the_delivery_has_delivered_by_chance(self, exit, cause_id):
        """If the node ends some time later, the delivery counts, but delivers_once fails."""
        at_once = self.run_of(('first', 'first'), lives=(), exit=exit)
        later = self.run_of(('first', 'first'), lives=('delivered',), exit=exit)

        assert cause_of(courier.delivers_to_who_comes_late, at_once) == cause_id
        courier.delivers_to_who_comes_late(later)
        assert cause_of(courier.delivers_once, later) == cause_id


class TestRunningMean:
    @staticmethod
    def mean(value, after_input):
        facts = {'event': 'message', 'topic': '/mean', 'data': {'data': value}}
        return {**facts, 'after_input': after_input}

    @staticmethod
    def cause(check, *events):
        """Return the id of the cause for which a check fails in a run with these events."""
        judge = next(one.judge for one in running_mean.exam.checks if one.name == check)
        return cause_of(judge, Run({}, Recording({}, (*events, *RUNS)), running_mean.exam.facts))

    @pytest.mark.parametrize(
        ('answers', 'cause_id'),
        [
            ([4.0, 8.0, -2.5, 11.0], 'passes_on'),
            ([4.0, 12.0, 9.5, 20.5], 'sum'),
            ([2.0, 4.0, 9.5 / 4, 4.1], 'wrong_count'),
            ([4.0, 6.0, 3.17, 5.12], 'rounded'),
            ([4.0, 6.0, 3.0, 5.0], 'whole_numbers'),
            ([4.0, 6.0, 2.75, 4.25], 'last_few'),
            ([0.0, 4.0, 6.0, 9.5 / 3], 'one_behind'),
            ([1.0, 2.0, 3.0, 4.0], None),
        ],
    )
    def test_wrong_mean_is_explained(self, answers, cause_id):
        """Only a cause that fits every answer is named."""
        inputs = [{'event': 'input', 'index': place} for place, _ in enumerate(answers)]
        said = [self.mean(answer, place) for place, answer in enumerate(answers)]
        events = [event for both in zip(inputs, said) for event in both]

        assert self.cause('publishes_the_mean', *events) == cause_id

    def test_two_topics_that_changed_places_are_named_together(self):
        """Neither topic has a wrong name: their directions are swapped."""
        ends = [
            {'topic': topic, 'kind': kind, 'node': '/running_mean', 'type': running_mean.TYPE}
            for topic, kind in (('/mean', 'subscription'), ('/readings', 'publisher'))
        ]
        graph = {'event': 'graph', 'nodes': ['/running_mean'], 'endpoints': ends}

        assert self.cause('reads_and_writes', graph) == 'wrong_direction'

    def test_message_before_the_first_number_is_no_answer(self):
        """Code other than the callback has published such a message."""
        assert self.cause('answers_every_number', self.mean(0.0, None)) == 'speaks_unasked'
