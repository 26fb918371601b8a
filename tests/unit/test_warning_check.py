"""The exam of lesson 11: prepared runs, and the causes if a check misjudges them."""

from dataclasses import replace
import json

from handmade_runs import at, message, run_of
import pytest

from autograder.errors import ExamInvalid
from autograder.exam import catalog
from autograder.exam.specification import Slip
from autograder.judging.judge import judge
from autograder.results import Verdict
from autograder.simulated import Simulation
from exams.visible import warning_check
from exams.visible.warning_check import celsius, made_run

EXAM = warning_check.exam
RUNS = EXAM.asks['answers'].inputs


def results(answers, exam=EXAM):
    """Return the exam's results for these answers, by check."""
    events = []
    for place, answer in enumerate(answers):
        events.append(at(place, 'input', index=place, data={}))
        facts = {'topic': warning_check.ANSWERS, 'listener': None, 'after_input': place}
        texts = answer if isinstance(answer, tuple) else (str(answer),)
        events += [message(place, data={'data': one}, **facts) for one in texts]
    return {one.check: one for one in judge(exam, run_of(*events, facts=exam.facts))}


def accepting(cause_id, exam=EXAM):
    """Return the right answers, except for True if a node has this slip."""
    slips = [one.slip for one in exam.asks['answers'].inputs]
    return [slip is None or slip.cause_id == cause_id for slip in slips]


def of_rule(rule, exam=EXAM):
    """Return the exam's results for a check that follows a rule."""
    return results(rule(exam.asks['answers'].inputs), exam)


def test_right_answers_get_all_points():
    found = of_rule(lambda runs: [one.slip is None for one in runs])

    assert {one.verdict for one in found.values()} == {Verdict.PASSED}
    assert sum(one.points for one in found.values()) == EXAM.max_points == 12


@pytest.mark.parametrize('answer', [True, False, 'NoneType', 'exception', ()])
def test_one_answer_for_all_runs_earns_nothing_but_its_form(answer):
    found = results([answer] * len(RUNS))

    points = {name: one.points for name, one in found.items() if one.points}
    assert points == ({'returns_true_or_false': 1} if isinstance(answer, bool) else {})


@pytest.mark.parametrize('slip', warning_check.SLIPS, ids=lambda slip: slip.cause_id)
def test_slip_of_a_check_is_the_cause_in_the_graded_exam(slip):
    exam = catalog.load('warning_check')
    found = of_rule(slip.rules[0], exam)

    causes = {one.cause_id for one in found.values() if one.verdict is Verdict.FAILED}
    assert slip.cause_id in causes
    assert causes <= {slip.cause_id, 'one_sided'}


def test_check_with_a_mistake_of_a_node_is_located_like_the_node():
    """The acts of a mistake are in the text of an exam or in the table of all exams."""
    acts = {slip.cause_id: slip.act for slip in warning_check.SLIPS}

    assert 'startswith()' in acts['check_first_letter']
    assert 'isnan()' in acts['check_nan']


def test_missed_run_is_explained_by_what_its_node_does():
    missed = accepting('nan')
    # Add another mistake, so that no slip of a check explains both.
    missed[5] = False
    found = results(missed)['refuses_other_warnings']

    assert found.cause_id == 'accepts_nan'
    assert found.cause.startswith('The node of this run is wrong. It logs a WARN line for NaN')
    assert found.observed == 'False for 3 of 4 runs; not for run 9, with a reading that is NaN'
    assert found.points == 2.25


def test_no_mistake_of_a_node_reads_as_the_learners():
    """The node with the mistake is not the learner's: the learner has written a check."""
    slips = (*warning_check.OF_A_MONITOR, warning_check.LATE, warning_check.LAGS)
    known = {*warning_check.MISSES, *warning_check.UNITS, *warning_check.WRONG}
    texts = [warning_check._of_a_node(slip) for slip in slips if slip.cause_id in known]

    assert len(texts) >= len(known)
    assert not [text for text in texts if 'your' in text.lower()]


@pytest.mark.parametrize(
    ('exam', 'slip'), [(EXAM, 'one_late'), (catalog.load('warning_check'), 'warns_later')]
)
def test_late_warning_is_explained(exam, slip):
    answers = accepting(slip, exam)
    answers[answers.index(True)] = False
    found = results(answers, exam)

    assert f'accepts_{slip}' in {one.cause_id for one in found.values()}


def test_graded_exam_names_no_place_and_no_value():
    """The order of the runs is secret: otherwise a list of answers would be enough."""
    exam = catalog.load('warning_check')
    found = of_rule(lambda runs: [True] * len(runs), exam)['refuses_other_warnings']
    slipped = {one.kind for one in exam.asks['answers'].inputs if one.slip}

    assert found.observed.removeprefix('False for 0 of 9 runs; not for a run with ') in slipped


def test_two_answers_for_a_run_are_none():
    found = results([('True', 'False')] * len(RUNS))['returns_true_or_false']

    assert found.observed == 'True, False for run 1, with readings in Celsius'
    assert found.cause_id == 'no_boolean'


def test_what_is_sent_does_not_tell_right_runs_from_wrong_ones():
    exam = catalog.load('warning_check')
    sent = [json.loads(one['data']) for one in exam.scenario.steps[0].messages]
    about = {(one['program'], one['reason'], one['mode'], one['printed']) for one in sent}

    assert about == {('monitor.py', 'complete', '', '')}
    for right in (True, False):
        words = {one.words for one in exam.asks['answers'].inputs if (one.slip is None) == right}
        assert words == {0, 1, 2, 3}


def test_graded_exam_asks_about_slips_that_learners_do_not_see():
    visible, hidden = (
        {one.slip.cause_id for one in exam.asks['answers'].inputs if one.slip}
        for exam in (EXAM, catalog.load('warning_check'))
    )

    assert visible < hidden


def test_run_survives_the_way_to_the_sandbox():
    run = RUNS[7].simulation

    assert Simulation.from_json(json.loads(json.dumps(run.to_json()))).logs == run.logs
    assert [line.time_s for line in run.logged('WARN')] == [1.0, 4.0]
    assert run.sent['/temperature_topic'].times == (1.0, 2.0, 3.0, 4.0)


def test_run_that_does_not_show_its_slip_is_refused():
    assert made_run('the limit', celsius(30.0), 'warns_at_threshold').answers == [1]
    with pytest.raises(ExamInvalid, match='do not reveal a slip warns_at_threshold'):
        made_run('cool readings', celsius(20.0), 'warns_at_threshold')


def test_slip_that_no_check_refuses_is_an_error_of_the_exam():
    slip = Slip('new_slip', 'It warns of NaN.', 'Do not.', lambda readings: [1])
    run = replace(made_run('a reading that is NaN', (warning_check.NAN,)), slip=slip)

    with pytest.raises(ExamInvalid, match=r'with the slip new_slip\. Try: .* MISSES, UNITS or'):
        warning_check.build((*RUNS, run))
