"""Test new verdicts from recordings after an edit to an exam, and the evidence for one verdict."""

from dataclasses import replace
import json
import shutil
import time

from conftest import ASSIGNMENT, copied
from nbgrader.api import Gradebook
import pytest

from autograder import __main__ as command
from autograder.authoring import sample_class
from autograder.classroom.collected import save_collected, Work
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import graded as results_of
from autograder.classroom.results_of_class import last_results, ran_s
from autograder.commands import FOR_REVIEW, OK
from autograder.commands.explain import evidence, MOST_LINES, WIDEST
from autograder.commands.rejudge import account_text, changes, rejudge, rejudge_command
from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam, Failed
from autograder.gradebook.record import record
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.sandboxes.choose import strongest
from autograder.submission.inbox import discover
from exams.visible.temperature_publisher import build

STUDENTS = (
    'pass__reference',
    'fail__two_hertz',
    'fail__stamps_without_nanoseconds',
    'fail__crashes_in_mid_run',
)
pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]


class OneExam(Engine):
    """An engine with only the publisher's exam, so that no message is built."""

    def exams(self, assignment):
        """Return the publisher's exam in its current version."""
        return catalog.for_assignment(assignment)


def fit(layout: Layout, exam: Exam) -> None:
    """Give the course one check cell, with the points of an exam."""
    name = Layout.here().release(ASSIGNMENT).name
    for folder in (layout.solutions, layout.notebooks):
        path = folder / ASSIGNMENT / name
        notebook = json.loads(path.read_text(encoding='utf-8'))
        for cell in list(notebook['cells']):
            marks = cell['metadata'].get('nbgrader', {})
            if marks.get('grade_id') == f'check_{exam.name}':
                marks['points'] = exam.max_points
            elif marks.get('grade_id', '').startswith('check_'):
                notebook['cells'].remove(cell)
        path.write_text(json.dumps(notebook), encoding='utf-8')


@pytest.fixture(scope='module')
def graded(released, tmp_path_factory):
    """Return a course in which four students were graded with real runs."""
    layout, here = copied(released, tmp_path_factory.mktemp('graded')), Layout.here()
    fit(layout, build(20, 0.07, 1.25, 20.0))
    for name in STUDENTS:
        place = layout.submitted / name / ASSIGNMENT
        place.mkdir(parents=True)
        data = sample_class.compose(here, ASSIGNMENT, here.sample_class / ASSIGNMENT / name)
        (place / here.release(ASSIGNMENT).name).write_bytes(data)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(catalog, 'for_assignment', lambda *_, **__: (build(20, 0.07, 1.25, 20.0),))
        engine = OneExam(strongest(), layout.recordings)
        lesson = load_lesson(layout, ASSIGNMENT, engine)
        class_ = discover(layout.submitted, ASSIGNMENT, lesson.notebook)
        results = [one.result for one in grade_class(class_, lesson, engine, jobs=2)]
    write_all_reports(layout, ASSIGNMENT, results)
    return layout


@pytest.fixture
def layout(graded, tmp_path):
    return copied(graded.root, tmp_path)


@pytest.fixture
def now(monkeypatch, layout):
    """Return a function that replaces the graded exam by a different one."""

    def put(exam: Exam) -> None:
        fit(layout, exam)
        monkeypatch.setattr(catalog, 'for_assignment', lambda *_, **__: (exam,))

    put(build(20, 0.07, 1.25, 20.0))
    return put


def by_student(accounts):
    (account,) = accounts
    return {one['student']: one for one in account['submissions']}


class TestRejudge:
    def test_it_takes_at_most_twenty_milliseconds_a_submission(self, layout, now):
        """The limit is CPU time: a busy machine must not fail this test."""
        lesson = load_lesson(layout, ASSIGNMENT)
        (last,) = results_of(layout)
        rejudge(layout, lesson, last, layout.submitted)  # import and read everything once
        each = []
        for _ in range(3):  # use the minimum, because Python's garbage collection also takes time
            began = time.process_time()
            account, *_ = rejudge(layout, lesson, last, layout.submitted)
            each.append((time.process_time() - began) / len(account['submissions']))

        assert not any(one['kept'] for one in account['submissions'])
        assert min(each) <= 0.020

    def test_an_unchanged_exam_changes_nothing(self, layout, now):
        accounts = rejudge_command(layout, None, None, write=False)

        assert [one['kept'] for one in accounts[0]['submissions']] == [''] * 4
        assert [one['changed'] for one in accounts[0]['submissions']] == [[]] * 4
        assert '4 of 4 submissions judged again' in account_text(accounts[0])

    def test_it_is_listed_who_has_other_points_by_which_check_and_why(self, layout, now):
        """The account lists an edited check, one with more points, and a new one."""
        exam = build(20, 0.07, 1.25, 20.0)

        def names_the_unit(run):
            """Every reading has the unit Kelvin."""
            raise Failed(expected='the unit Kelvin', observed='the unit Celsius')

        def is_new(run):
            """It is there."""

        checks = {check.name: check for check in exam.checks}
        exam.checks = [
            *(checks[name] for name in ('starts_its_node', 'publishes_readings')),
            replace(checks['names_the_unit'], judge=names_the_unit),
            replace(checks['names_the_sensor'], points=4),
        ]
        exam.check(points=1)(is_new)
        now(exam)

        accounts = rejudge_command(layout, None, None, write=False)
        reference = by_student(accounts)['pass__reference']
        changed = {one['check']: one for one in reference['changed']}

        assert (reference['before'], reference['after']) == (15, 9)
        assert changed['names_the_unit']['points_after'] == 0
        assert 'expected the unit Kelvin; observed the unit Celsius' in account_text(accounts[0])
        why = 'the points of the check have changed: 1 -> 4'
        assert changed['names_the_sensor']['why'] == why
        assert changed['is_new']['why'] == 'the check is new'
        assert changed['readings_are_plausible']['after'] == 'no such check'
        assert 'starts_its_node' not in changed

    def test_only_students_with_a_changed_check_are_listed(self):
        """A check that now waits for another one has no expected and observed behaviour."""

        def result(*checks):
            found = (
                CheckResult(name, 'T', verdict, points, 3) for name, verdict, points in checks
            )
            return ExamResult('e', tuple(replace(one, waits_for='runs') for one in found))

        failed, waits, passed = Verdict.FAILED, Verdict.NOT_RUN, Verdict.PASSED
        before = result(('says', failed, 0), ('runs', passed, 3))
        same = result(('says', waits, 0), ('runs', passed, 3))
        less = result(('says', waits, 0), ('runs', failed, 2))
        rows = [
            {
                'student': student,
                'before': before.points,
                'after': after.points,
                'max_points': 6,
                'kept': '',
                'changed': list(changes(before, after)),
            }
            for student, after in (('ann', same), ('bob', less), ('cho', before))
        ]
        account = {'assignment': '01', 'seconds': 0.0, 'written': '', 'lowered': []}

        lines = account_text({**account, 'submissions': rows}).splitlines()
        same_points, says, head, *says_too, runs, summary = lines
        assert same_points == 'ann: 3 -> 3 of 6 points'
        assert says_too == [says]
        assert head == 'bob: 3 -> 2 of 6 points'
        assert says == '  e/says: FAILED -> NOT_RUN, 0 -> 0 points; it waits for runs'
        assert runs == '  e/runs: PASSED -> FAILED, 3 -> 2 points; previous result: PASSED'
        assert summary.endswith('; 2 changed. Nothing was written. Try: --write')

    def test_another_scenario_needs_another_run(self, layout, now):
        now(build(21, 0.07, 1.25, 20.0))

        accounts = rejudge_command(layout, None, None, write=False)

        for one in accounts[0]['submissions']:
            assert 'the scenario of the exam has changed' in one['kept']
            assert one['after'] == one['before']

    def test_who_has_no_recording_is_named_and_keeps_the_points(self, layout, now):
        """Students who have since changed or withdrawn their submission keep their points, too."""
        for path in layout.recordings.rglob('*.jsonl'):
            text = path.read_text(encoding='utf-8')
            if 'IndexError' in text or 'Traceback' in text:
                path.unlink()
        other = layout.submitted / 'pass__reference'
        shutil.rmtree(layout.submitted / 'fail__two_hertz')
        shutil.copytree(other, layout.submitted / 'fail__two_hertz')
        shutil.rmtree(other)

        accounts = rejudge_command(layout, None, None, write=False)
        kept = {name: one['kept'] for name, one in by_student(accounts).items()}

        assert kept['pass__reference'] == 'the submission no longer exists'
        assert 'the files have changed since the recording' in kept['fail__two_hertz']
        assert 'cannot be read' in kept['fail__crashes_in_mid_run']
        assert kept['fail__stamps_without_nanoseconds'] == ''

    def test_nothing_is_written_unless_asked(self, layout, now):
        """With --write, both the reports and the gradebook have the new points."""
        exam = build(20, 0.07, 1.25, 20.0)

        def refuse(run):
            raise Failed(expected='more', observed='less')

        exam.checks = [
            replace(check, judge=refuse) if check.name == 'offers_reliable_qos' else check
            for check in exam.checks
        ]
        now(exam)
        results = layout.reports / ASSIGNMENT / 'results.json'
        before = results.read_text(encoding='utf-8')

        rejudge_command(layout, None, None, write=False)
        assert results.read_text(encoding='utf-8') == before

        (account,) = rejudge_command(layout, None, None, write=True)
        assert account['written'] == (
            'The reports show the new points of 4 submissions; new in the gradebook: 4, '
            'unchanged: 0.'
        )
        data = {one['student']: one for one in json.loads(results.read_text(encoding='utf-8'))}
        points = [check['points'] for check in data['pass__reference']['exams'][0]['checks']]
        assert sum(points) == 14
        with Gradebook(f'sqlite:///{layout.work}/gradebook.db') as book:
            entered = book.find_submission(ASSIGNMENT, 'pass__reference')
            assert entered.score == 14

    def test_only_who_has_another_result_is_entered(self, layout, now, monkeypatch):
        """Other students are unchanged, and the list of slowest runs stays the same."""
        given = []

        def noted(layout, lesson, graded):
            given.append({one.result.student for one in graded})
            record(layout, lesson, graded)

        monkeypatch.setattr('autograder.gradebook.live_entry.record', noted)
        slowest = [(one.student, ran_s(one)) for one in last_results(layout, ASSIGNMENT)]
        rejudge_command(layout, None, None, write=True)
        (unchanged,) = rejudge_command(layout, None, None, write=True)
        exam = build(20, 0.07, 1.25, 20.0)
        exam.checks = [
            replace(check, judge=lambda run: None)
            if check.name == 'publishes_once_per_second'
            else check
            for check in exam.checks
        ]
        now(exam)
        (account,) = rejudge_command(layout, None, None, write=True)

        changed = {one['student'] for one in account['submissions'] if one['changed']}
        assert 'fail__two_hertz' in changed
        assert len(changed) < len(STUDENTS)
        assert given == [set(STUDENTS), changed]
        assert 'new in the gradebook: 0, unchanged: 4' in unchanged['written']
        assert [(one.student, ran_s(one)) for one in last_results(layout, ASSIGNMENT)] == slowest
        assert all(seconds > 0 for _, seconds in slowest)

    def test_what_was_never_graded_cannot_be_judged_again(self, course):
        with pytest.raises(GraderError, match='Try: make grade'):
            rejudge_command(course, None, None, write=False)


class TestExplain:
    def test_the_moment_is_marked_and_what_was_said_is_there(self, layout, now):
        """The evidence has at most forty short lines; five readings are enough to judge."""
        text = evidence(layout, 'fail__stamps_without_nanoseconds', 'stamps_follow_the_clock')
        (result,) = [
            one
            for one in last_results(layout, ASSIGNMENT)
            if one.student == 'fail__stamps_without_nanoseconds'
        ]
        name = result.exams[0].recording
        made_with = Recording.load(layout.recordings / 'temperature_publisher' / name).header
        (marked,) = [line for line in text.splitlines() if line.startswith('>')]

        assert '5.600s  /temperature_topic: ' in marked
        assert 'timestamp: 7.000000000' in marked
        assert text.splitlines()[1].startswith('FAILED, ')
        assert '  judged again now from the recording: same verdict\n' in text
        assert 'made from these files' in text
        assert f'recording: {name}, SHA-256 ' in text
        assert f'rclpy {made_with["made_with"]["rclpy"]}' in text
        assert len(text.splitlines()) <= MOST_LINES
        assert max(map(len, text.splitlines())) <= WIDEST

    def test_a_rate_is_shown_from_the_first_wrong_second(self, layout, now):
        """The check names the moment, because no single message is wrong."""
        text = evidence(layout, 'fail__two_hertz', 'publishes_once_per_second')
        (marked,) = [line for line in text.splitlines() if line.startswith('>')]

        assert 'First deviation: the check reported its failure at this event.' in text
        assert '0.800s' in marked  # half a second too early

    def test_a_program_that_died_is_shown_with_its_last_words(self, layout, now):
        text = evidence(layout, 'fail__crashes_in_mid_run', 'names_the_unit')

        assert 'First deviation: the run ended early here.' in text
        assert 'last lines that the program printed:' in text
        assert 'Error' in text

    def test_a_verdict_that_passed_has_evidence_too(self, layout, now):
        """The evidence shows the beginning of the run, without a deviation."""
        text = evidence(layout, 'pass__reference', 'names_the_unit')

        assert 'PASSED, 1 of 1 points' in text
        assert not [line for line in text.splitlines() if line.startswith('>')]

    def test_evidence_of_a_second_start_is_from_this_start(self, layout, now):
        results = {one.student: one for one in last_results(layout, ASSIGNMENT)}
        name = results['pass__reference'].exams[0].recording
        recording = Recording.load(layout.recordings / 'temperature_publisher' / name)
        first, second = (
            evidence(layout, 'pass__reference', check)
            for check in ('names_the_unit', 'readings_are_plausible')
        )

        assert 'In the second start of the program:\n' in second
        assert f'  {len(recording.again.events)} events, end: complete' in second
        assert f'  {len(recording.events)} events, end: complete' in first
        assert 'second start' not in first

    @pytest.mark.parametrize(
        ('student', 'check', 'said'),
        [
            ('pass_reference', 'names_the_unit', 'Did you mean pass__reference'),
            ('pass__reference', 'nothing', 'Try: explain STUDENT, which lists all checks'),
            (
                'pass__reference',
                'names_unit',
                r'Try: name one of temperature_publisher/names_the_unit',
            ),
            (
                'pass__reference',
                'temperature_publisher',
                'Try: name one of temperature_publisher/s',
            ),
            ('pass__reference', 'other/names_the_unit', 'has no check with this name'),
        ],
    )
    def test_who_or_what_is_not_there_is_answered_with_what_is(
        self, layout, now, student, check, said
    ):
        with pytest.raises(GraderError, match=said):
            evidence(layout, student, check)

    def test_an_edited_exam_says_what_comes_out_now(self, layout, now):
        exam = build(20, 0.07, 1.25, 20.0)
        exam.checks = [
            replace(check, judge=lambda run: None) if check.name == 'names_the_sensor' else check
            for check in exam.checks
        ]
        exam.checks = [
            replace(check, judge=lambda run: None)
            if check.name == 'publishes_once_per_second'
            else check
            for check in exam.checks
        ]
        now(exam)

        text = evidence(layout, 'fail__two_hertz', 'publishes_once_per_second')

        assert text.splitlines()[1].startswith('FAILED, ')
        assert '  judged again now from the recording: PASSED, 3 of 3 points\n' in text


class TestCommands:
    @pytest.fixture(autouse=True)
    def here(self, layout, now, monkeypatch):
        """Make the graded course the current one."""
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))

    def test_rejudge_returns_for_review_when_a_scenario_has_changed(self, now):
        """A different scenario needs a new run."""
        now(build(21, 0.07, 1.25, 20.0))

        assert command.main(['rejudge']) == FOR_REVIEW

    def test_rejudge_prints_an_account(self, capsys):
        """With ``--json``, the command prints the whole account as JSON."""
        assert command.main(['rejudge', 'temperature_monitor']) == OK
        said = capsys.readouterr().out
        assert said.startswith(f'{ASSIGNMENT}: 4 of 4 submissions judged again in ')
        assert said.endswith('without a run; 0 changed. Nothing was written.\n')

        assert command.main(['rejudge', '--json']) == OK
        (account,) = json.loads(capsys.readouterr().out)
        assert {one['student'] for one in account['submissions']} == set(STUDENTS)

    def test_a_refusal_of_the_gradebook_is_reported_after_the_reports(
        self, layout, now, capsys, monkeypatch
    ):
        """Reports and account come first, then the reason; the exit code is 2."""

        def refuse(*_):
            raise GraderError('nbgrader failed while recording: no disk.')

        exam = build(20, 0.07, 1.25, 20.0)
        exam.checks = [replace(check, points=7) for check in exam.checks]
        now(exam)
        monkeypatch.setattr('autograder.gradebook.live_entry.record', refuse)

        assert command.main(['rejudge', '--write']) == command.USAGE
        said = capsys.readouterr()
        assert 'the gradebook did not accept all of the 4 changed results.' in said.out
        assert said.err == 'autograder: nbgrader failed while recording: no disk.\n'
        points = {one.student: one.points for one in last_results(layout, ASSIGNMENT)}
        assert points['pass__reference'] == 7 * len(exam.checks)
        page = (layout.reports / ASSIGNMENT / 'class.html').read_text(encoding='utf-8')
        assert '4 of 4 submissions were judged again from recordings.' in page

        assert command.main(['rejudge', '--write', '--json']) == command.USAGE
        (account,) = json.loads(capsys.readouterr().out)
        assert account['refused'] == 'nbgrader failed while recording: no disk.'

    def test_explain_prints_evidence(self, capsys):
        """An unknown student causes a one-line error."""
        wanted = ['explain', 'fail__two_hertz', 'temperature_publisher/publishes_once_per_second']
        assert command.main(wanted) == OK
        assert 'FAILED, 0 of 3 points' in capsys.readouterr().out

        assert command.main(['explain', 'nobody', 'x']) == command.USAGE
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith('autograder: nobody: there is no such student')

    def test_explain_without_a_check_lists_the_checks_of_a_student(self, layout, capsys):
        """The list has verdict, points and cause; the student is given by id or name."""
        save_collected(layout, [Work('fail__two_hertz', person='Ann Lee')])

        assert command.main(['explain', 'ann lee']) == OK
        head, *lines, last = capsys.readouterr().out.splitlines()
        assert head.startswith(f'fail__two_hertz (Ann Lee), {ASSIGNMENT}: ')
        (rate,) = [line for line in lines if 'temperature_publisher/publishes_once' in line]
        assert rate.split()[:4] == ['FAILED', '0', 'of', '3']
        assert 'one message every 0.5 s' in rate
        assert {line.split()[4].partition('/')[0] for line in lines} == {'temperature_publisher'}
        assert 'To see the evidence' in last

        assert command.main(['explain', 'Ann Lee', 'publishes_once_per_second']) == OK
        assert capsys.readouterr().out.startswith('fail__two_hertz, ')

    def test_what_was_not_graded_is_one_line(self, capsys):
        assert command.main(['rejudge', '03_topics']) == command.USAGE
        assert 'Did you mean 07_temperature_monitor?' in capsys.readouterr().err
        assert command.main(['explain', 'ann', 'x', '--assignment', 'topics']) == command.USAGE
        assert 'topics: there is no such assignment' in capsys.readouterr().err
