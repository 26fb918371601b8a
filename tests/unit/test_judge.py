"""The judge has no side effects, so handmade recordings can test it."""

from dataclasses import replace

import pytest

from autograder.errors import ExamInvalid, GraderError
from autograder.exam.exam import Advance, Cause, Exam, Failed, Run, Scenario
from autograder.judging.judge import closest, judge, worth_running
from autograder.recording import Recording
from autograder.results import Verdict
from autograder.submission.code.source_code import Code

NOTHING = Recording({}, ())


def make_exam(**options):
    facts = {'title': 'T', 'assignment': '01_x', 'part': 1, 'cells': ('a',), 'requires': ()}
    facts['scenario'] = Scenario()
    return Exam('sample', **{**facts, **options})


def passes(run):
    """It works."""


def fails(run):
    """It fails."""
    raise Failed(expected='1', observed='2', why=Cause('because', 'why', 'this'))


def breaks(run):
    """It breaks."""
    raise KeyError('ours')


CODE = {'a.py': 'timer = node.create_timer(0.7, f)\nlog.info(1)\nlog.info(2)\n'}


@pytest.mark.parametrize(
    ('why', 'line', 'place'),
    [
        (Cause('wrong_rate', 'It is fast.', '', ['0.7']), None, 'Line 2: '),
        (Cause('wrong_rate', 'It is fast.', '', ['0.7'], line=8), None, 'Line 9: '),
        (Cause('not_in_the_table', 'It is fast.', '', ['0.7']), None, ''),
        (Cause('no_number', 'It has no number.', ''), 3, 'Line 4: '),
        (Cause('no_number', 'It has no number.', ''), None, ''),
        (Cause('of_an_exam', 'It is fast.', '', act='create_timer()'), None, 'Line 2: '),
    ],
)
def test_cause_begins_with_the_line_of_its_act(why, line, place):
    """The line is counted in the cell; a line that the run shows takes precedence."""
    exam = make_exam()

    def dies(run):
        """It dies."""
        raise Failed(expected='1', observed='2', why=why, shown_by=[{'line': line}])

    exam.check(points=1)(dies)

    (result,) = judge(exam, Run(CODE, NOTHING))

    assert result.cause == f'{place}{why.text}'


def test_more_precise_cause_is_given_if_the_program_does_its_act():
    """The act of the cause ``a`` does not occur; the act of ``b`` has to occur twice."""
    closer = [
        Cause('a', 'It sleeps.', '', act='sleep()'),
        Cause('b', 'It logs.', '', act='info()+'),
    ]
    why = Cause('wrong_rate', 'It is fast.', '', closer=closer)
    code = 'node.create_timer(0.7, f)\ndef f():\n    log.info(1)\n    log.info(2)\n'

    assert closest(Code({'a.py': code}), why).cause_id == 'b'
    assert closest(Code({'a.py': 'log.info(1)\n'}), why) is why


class TestJudge:
    def test_passed_check_earns_its_points(self):
        exam = make_exam()
        exam.check(points=3)(passes)

        (result,) = judge(exam, Run({}, NOTHING))

        assert (result.verdict, result.points, result.title) == (Verdict.PASSED, 3, 'It works.')

    @pytest.mark.parametrize(
        ('cause_id', 'place'),
        [
            ('no_field', 'lesson 08, Part 5: Messages and fields'),
            ('because', 'Part 2'),
        ],
    )
    def test_exception_is_read_about_where_it_is_explained(self, cause_id, place):
        exam = make_exam(read='Part 1')

        def dies(run):
            """It lives."""
            raise Failed(expected='1', observed='2', why=Cause(cause_id, 'why', 'this'))

        exam.check(points=2, read='Part 2')(dies)

        (result,) = judge(exam, Run({}, NOTHING))

        assert result.read == place

    def test_failure_that_blocks_nothing_costs_its_own_points_alone(self):
        """For example, the messages of a node with a wrong name are still judged."""
        exam = make_exam()

        @exam.check(points=1)
        def has_its_name(run):
            """It has its name."""
            raise Failed(expected='a', observed='b', blocks=False)

        exam.check(points=4, needs=['has_its_name'])(passes)

        assert [one.points for one in judge(exam, Run({}, NOTHING))] == [0, 4]

    def test_failed_check_tells_five_things(self):
        exam = make_exam(read='Part 1')
        exam.check(points=2)(fails)

        (result,) = judge(exam, Run({}, NOTHING))

        assert result.verdict is Verdict.FAILED
        assert result.points == 0
        assert (result.expected, result.observed, result.cause) == ('1', '2', 'why')
        assert (result.try_this, result.read, result.cause_id) == ('this', 'Part 1', 'because')

    def test_check_whose_need_failed_is_not_run_and_names_it(self):
        exam = make_exam()
        exam.check(points=1)(fails)
        exam.check(points=4, needs=['fails'])(passes)

        result = judge(exam, Run({}, NOTHING))[1]

        assert (result.verdict, result.points, result.waits_for) == (Verdict.NOT_RUN, 0, 'fails')
        assert 'It fails.' in result.observed

    def test_share_gives_part_of_the_points(self):
        exam = make_exam()

        @exam.check(points=4)
        def half(run):
            """Half."""
            raise Failed(expected='all', observed='half', share=0.5)

        assert judge(exam, Run({}, NOTHING))[0].points == 2

    def test_broken_check_is_the_graders_fault(self):
        exam = make_exam()
        exam.check(points=1)(breaks)

        with pytest.raises(GraderError, match='breaks of exam sample broke: KeyError'):
            judge(exam, Run({}, NOTHING))


class TestWorthRunning:
    def test_run_that_waits_for_a_failed_file_check_is_not_worth_it(self):
        exam = make_exam()
        exam.check(points=1, static=True)(fails)
        exam.check(points=1, needs=['fails'])(passes)

        assert not worth_running(exam, {})

    def test_independent_check_makes_the_run_worth_it(self):
        exam = make_exam()
        exam.check(points=1, static=True)(fails)
        exam.check(points=1)(passes)

        assert worth_running(exam, {})

    def test_blocking_passes_on(self):
        exam = make_exam()
        exam.check(points=1, static=True)(fails)
        exam.check(points=1, needs=['fails'])(passes)

        @exam.check(points=1, needs=['passes'])
        def later(run):
            """Later."""

        assert not worth_running(exam, {})


class TestExam:
    def test_unknown_need_is_refused_with_the_earlier_names(self):
        exam = make_exam()
        exam.check(points=1)(passes)

        with pytest.raises(ExamInvalid, match=r"needs 'pases'.*Earlier checks: passes"):
            exam.check(points=1, needs=['pases'])(fails)

    def test_name_used_twice_is_refused(self):
        exam = make_exam()
        exam.check(points=1)(passes)

        with pytest.raises(ExamInvalid, match='used twice'):
            exam.check(points=1)(passes)

    def test_check_without_points_is_refused(self):
        """If a check without points were missing, nobody would notice."""
        with pytest.raises(ExamInvalid, match='points > 0'):
            make_exam().check(points=0)(passes)

    def test_check_without_docstring_is_refused(self):
        """Learners read the docstring as the sentence of the check."""

        def silent(run):
            pass

        with pytest.raises(ExamInvalid, match='no docstring'):
            make_exam().check(points=1)(silent)

    def test_check_of_a_run_is_refused_where_nothing_runs(self):
        exam = make_exam(scenario=Scenario(program=''))
        exam.check(points=1, static=True)(passes)

        with pytest.raises(ExamInvalid, match='runs no program'):
            exam.check(points=1)(fails)

        assert not worth_running(exam, {})


class TestSecondStart:
    def test_check_sees_only_its_own_start(self):
        exam = make_exam(scenario=Scenario(file='a.py', again=Scenario(file='a.py')), requires=())
        seen = []

        def looks(run):
            """It looks."""
            seen.append([one['event'] for one in run.recording.events])

        exam.check(points=1, again=True)(looks)
        first = Recording({}, [{'event': 'end'}])
        for recording in (replace(first, again=Recording({}, [{'event': 'mark'}])), first):
            judge(exam, Run(CODE, recording))

        assert seen == [['mark'], []]

    def test_scenario_has_to_start_the_program_again(self):
        with pytest.raises(ExamInvalid, match='judges a second start'):
            make_exam(scenario=Scenario(file='a.py')).check(points=1, again=True)(passes)

    def test_mistake_in_the_second_start_is_found(self):
        with pytest.raises(ExamInvalid, match='again, step 1'):
            make_exam(scenario=Scenario(again=Scenario(steps=(Advance(0.0),))))
