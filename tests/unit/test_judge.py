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


def failing(**facts):
    def fails(run):
        """It fails."""
        raise Failed(**{'expected': '1', 'observed': '2', **facts})

    return fails


fails = failing(why=Cause('because', 'why', 'this'))


def breaks(run):
    """It breaks."""
    raise KeyError('ours')


def result_of(check, files=None, points=4, **options):
    """Return the result of an exam's only check."""
    exam = make_exam(read='Part 1')
    exam.check(points=points, **options)(check)
    (result,) = judge(exam, Run(files or {}, NOTHING))
    return result


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
    check = failing(why=why, shown_by=[{'line': line}])

    assert result_of(check, CODE).cause == f'{place}{why.text}'


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
        result = result_of(passes, points=3)

        assert (result.verdict, result.points, result.title) == (Verdict.PASSED, 3, 'It works.')

    @pytest.mark.parametrize(
        ('cause_id', 'place'),
        [('no_field', 'lesson 08, Part 5: Messages and fields'), ('because', 'Part 2')],
    )
    def test_exception_is_read_about_where_it_is_explained(self, cause_id, place):
        check = failing(why=Cause(cause_id, 'why', 'this'))

        assert result_of(check, read='Part 2').read == place

    def test_failure_that_blocks_nothing_costs_its_own_points_alone(self):
        """For example, the messages of a node with a wrong name are still judged."""
        exam = make_exam()
        exam.check(points=1)(failing(blocks=False))
        exam.check(points=4, needs=['fails'])(passes)

        assert [one.points for one in judge(exam, Run({}, NOTHING))] == [0, 4]

    def test_failed_check_tells_five_things(self):
        result = result_of(fails)

        assert (result.verdict, result.points) == (Verdict.FAILED, 0)
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
        assert result_of(failing(share=0.5)).points == 2

    def test_broken_check_is_the_graders_fault(self):
        with pytest.raises(GraderError, match='breaks of exam sample broke: KeyError'):
            result_of(breaks)


@pytest.mark.parametrize(
    ('needs', 'worth'),
    [
        pytest.param({'passes': ['fails']}, False, id='waits for a failed file check'),
        pytest.param({'passes': []}, True, id='independent'),
        pytest.param({'passes': ['fails'], 'breaks': ['passes']}, False, id='blocking passes on'),
    ],
)
def test_run_is_worth_it_if_a_check_can_be_judged(needs, worth):
    exam = make_exam()
    exam.check(points=1, static=True)(fails)
    for name, needed in needs.items():
        exam.check(points=1, needs=needed)({'passes': passes, 'breaks': breaks}[name])

    assert worth_running(exam, {}) is worth


class TestExam:
    @pytest.mark.parametrize(
        ('options', 'judged', 'said'),
        [
            ({'needs': ['pases']}, fails, r"needs 'pases'.*Earlier checks: passes"),
            ({}, passes, 'used twice'),
            # If a check without points were missing, nobody would notice.
            ({'points': 0}, fails, 'points > 0'),
            # Learners read the docstring as the sentence of the check.
            ({}, lambda run: None, 'no docstring'),
            ({'again': True}, fails, 'judges a second start'),
        ],
        ids=['unknown need', 'name used twice', 'no points', 'no docstring', 'no second start'],
    )
    def test_mistake_in_a_check_is_refused(self, options, judged, said):
        exam = make_exam()
        exam.check(points=1)(passes)

        with pytest.raises(ExamInvalid, match=said):
            exam.check(**{'points': 1, **options})(judged)

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

    def test_mistake_in_the_second_start_is_found(self):
        with pytest.raises(ExamInvalid, match='again, step 1'):
            make_exam(scenario=Scenario(again=Scenario(steps=(Advance(0.0),))))
