"""Reports are complete, readable without colour, and harmless, whatever a student wrote."""

from dataclasses import replace
import io
import json
import re

from bs4 import BeautifulSoup
import pytest
from rich.console import Console

from autograder.classroom import pages as report
from autograder.classroom.collected import save_collected, Work
from autograder.classroom.pages import page_name, print_table, write_all_reports
from autograder.explaining.feedback import exam_text, headline, printable
from autograder.explaining.feedback_html import with_unique_ids
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, Problem, SubmissionResult, Verdict

EVIL = '<script>alert(1)</script>&"\'\x1b[31m[bold]'


def failing(**changes):
    facts = {
        'expected': 'one warning',
        'observed': 'none',
        'cause': 'a typo',
        'try_this': 'look again',
        'read': 'Part 2',
    }
    return CheckResult('warns', 'It warns.', Verdict.FAILED, 0, 3, **{**facts, **changes})


PASSED = CheckResult('runs', 'It runs.', Verdict.PASSED, 2, 2)
WAITING = CheckResult('stops', 'It stops.', Verdict.NOT_RUN, 0, 1, waits_for='warns')


def submission(student='ann', checks=None, **more):
    checks = checks or (PASSED, failing(), WAITING)
    exam = ExamResult('talker', tuple(checks), 'watched', 'bwrap-user', ('odd',), {'run_s': 0.5})
    return SubmissionResult(student, '01_talker', (exam,), **more)


def written(folder, results, summary=''):
    """Write all pages of a class and return the path of the page of the class."""
    return write_all_reports(Layout(folder), '01_talker', results, summary)


def read(path):
    return BeautifulSoup(path.read_text(encoding='utf-8'), 'html.parser')


def page_of_ann(folder, result):
    return read(written(folder, [result]).parent / page_name('ann')).text


def links_of(path):
    parts = read(path)
    return [one['href'] for one in parts(href=True)] + [one['src'] for one in parts(src=True)]


def results_of(class_page):
    """Return the results that other programs can read."""
    data = json.loads((class_page.parent / 'results.json').read_text(encoding='utf-8'))
    return [SubmissionResult.from_json(one) for one in data]


class TestPages:
    def test_a_students_page_has_all_facts_and_verdicts_that_are_words(self, tmp_path):
        checks, _, about = page_of_ann(tmp_path, submission()).partition('About the grading')

        facts = ('It warns.', 'one warning', 'none', 'a typo', 'look again', 'Part 2')
        for part in (*facts, 'Passed:', 'Failed:', 'Not checked:', 'waits forIt warns.'):
            assert part in checks
        for part in ('bwrap-user', 'run for 0.5 s', 'Flag: odd'):
            assert part in about

    @pytest.mark.parametrize('place', ['student', 'observed', 'problem', 'fault', 'flag'])
    def test_hostile_words_stay_words(self, tmp_path, place):
        result = submission(
            student=EVIL if place == 'student' else 'ann',
            checks=[failing(observed=EVIL, cause='') if place == 'observed' else failing()],
            problems=(Problem(EVIL, 'a', 'b', 'c', (EVIL,)),) if place == 'problem' else (),
            fault=EVIL if place == 'fault' else '',
        )
        if place == 'flag':
            exam = ExamResult('talker', (PASSED,), EVIL, EVIL, (EVIL,))
            result = SubmissionResult('ann', '01_talker', (exam,))

        class_page = written(tmp_path, [result], EVIL)

        for path in class_page.parent.rglob('*.html'):
            assert not read(path)('script')
            assert '\x1b' not in path.read_text(encoding='utf-8')

    def test_pages_load_nothing_and_link_only_each_other(self, tmp_path):
        """The pages can therefore be sent by e-mail."""
        class_page = written(tmp_path, [submission(), submission('../b c')])

        here, *links = links_of(class_page)
        assert here == '#everybody'
        assert len(set(links)) == 2
        for link in links:
            assert links_of(class_page.parent / link) == []

    def test_a_fault_of_ours_is_no_zero(self, tmp_path):
        class_page = written(tmp_path, [submission(fault='probe broke')])

        assert 'for review' in read(class_page).text
        assert '2 of 6' not in read(class_page).text
        page = page_of_ann(tmp_path, submission(fault='probe broke'))
        assert 'no score yet' in page
        assert '2 of 6' not in page

    def test_a_new_report_replaces_the_old_one(self, tmp_path):
        written(tmp_path, [submission('old')])
        class_page = written(tmp_path, [submission('new')])

        assert [path.name for path in (class_page.parent / 'students').iterdir()] == ['new.html']

    def test_names_are_with_their_ids_and_not_on_a_students_page(self, tmp_path):
        """Learning platforms may use numbers as ids."""
        save_collected(Layout(tmp_path), [Work('ann', person='Ann <b>Example')])

        assert 'ann (Ann <b>Example)' in read(written(tmp_path, [submission()])).text
        assert 'Example' not in page_of_ann(tmp_path, submission())

    def test_the_results_are_there_whenever_writing_ends(self, tmp_path, monkeypatch):
        """Other commands need the results, so they are saved before the pages."""

        def stop(*_):
            raise KeyboardInterrupt

        class_page = written(tmp_path, [submission('old')])
        monkeypatch.setattr(report, '_templates', stop)
        with pytest.raises(KeyboardInterrupt):
            written(tmp_path, [submission('new')])

        assert [one.student for one in results_of(class_page)] == ['new']

    def test_the_results_are_kept_as_data(self, tmp_path):
        result = submission(problems=(Problem('x', 'a', 'b', 'c', ('talker',)),), fault='broken')

        (found,) = results_of(written(tmp_path, [result]))

        assert found == result
        assert all(isinstance(one.verdict, Verdict) for one in found.exams[0].checks)

    def test_points_and_flags_of_all_exams_are_combined(self):
        result = replace(submission(), exams=submission().exams * 2)

        assert (result.points, result.max_points, result.flags) == (4, 12, ('odd',))

    def test_no_id_of_a_page_is_repeated(self, tmp_path):
        """Two checks may have the same picture, which names its title by an id."""
        rows = [{'label': 'a', 'what': 'observed', 'count': 1, 'times': [2.0]}]
        picture = {'kind': 'timeline', 'unit': 'seconds', 'begin': 0.0, 'end': 9.0, 'rows': rows}
        exam = ExamResult(
            'talker', (failing(), PASSED), pictures={'warns': picture, 'runs': picture}
        )
        result = SubmissionResult('ann', '01_talker', (exam,))

        class_page = written(tmp_path, [result])

        page = (class_page.parent / 'students' / 'ann.html').read_text(encoding='utf-8')
        ids = re.findall(r'\sid="([^"]+)"', page)
        assert page.count('<svg') == 2
        assert len(ids) == len(set(ids)) == 5

    def test_pages_are_well_formed_for_readers(self, tmp_path):
        class_page = written(tmp_path, [submission()])

        for path in class_page.parent.rglob('*.html'):
            page = read(path)
            assert '<html lang="en">' in path.read_text(encoding='utf-8')
            assert len(page('h1')) == len(page('main')) == len(page.head('title')) == 1
        assert read(class_page)('caption')
        assert '<th scope="col">' in class_page.read_text(encoding='utf-8')

    @pytest.mark.parametrize(
        'name', ['ann', 'a/b', '..', 'index', 'ü', 'a%2Fb', 'x' * 80, 'Щ' * 100]
    )
    def test_every_name_has_a_page_of_its_own_below_students(self, tmp_path, name):
        class_page = written(tmp_path, [submission(name), submission('other')])

        assert len(list((class_page.parent / 'students').iterdir())) == 2


class TestTable:
    def printed(self, *results):
        console = Console(file=io.StringIO(), width=150)
        print_table(console, '01_talker', results, {}, ())
        return console.file.getvalue()

    def test_it_shows_student_points_and_first_cause_and_flags_below(self):
        *lines, last = self.printed(submission()).splitlines()
        line = next(line for line in lines if 'ann' in line)

        assert '2 of 6' in line
        assert 'a typo' in line
        assert 'flag: ann: odd' in last

    def test_hostile_words_do_not_steer_the_terminal(self):
        text = self.printed(submission(student=EVIL, checks=[failing(cause=EVIL)]))

        assert '\x1b[31m' not in text
        assert '[bold]' in text

    def test_a_fault_of_ours_shows_no_points(self):
        text = self.printed(submission(fault='probe broke'))

        assert 'for review' in text
        assert '2 of 6' not in text


class TestWords:
    def test_the_text_of_an_exam_begins_with_its_points(self):
        assert exam_text(submission().exams[0]).startswith('2 of 6 points\n')

    def test_control_characters_are_replaced(self):
        assert printable('a\x1b[1mb\n\tc\x00') == 'a\ufffd[1mb\n\tc\ufffd'

    def test_what_costs_points_comes_before_what_does_not(self):
        note = Problem('x', 'a', 'b', 'c')
        missing = Problem('y', 'a', 'b', 'c', ('talker',))

        assert headline(submission(problems=(note,))).startswith('a typo')
        assert headline(submission(problems=(note, missing))).startswith('y:')
        assert headline(submission(checks=[PASSED], problems=(note,))).startswith('x:')
        assert headline(submission(checks=[PASSED])) == ''
        assert headline(submission(fault='broken')) == 'broken'

    def test_headline_is_the_cause_that_costs_most_points(self):
        """Points of checks that wait for a failed check count towards its cause, in all exams."""
        wrong_id = CheckResult('id', 'T', Verdict.FAILED, 0, 1, cause='Another id.', cause_id='a')
        checks = (wrong_id, failing(cause='A wrong name.'), WAITING)
        cheap = (wrong_id, replace(failing(), points=2.5))
        again = (*checks, replace(wrong_id, check='id_again', max_points=4))

        assert headline(submission(checks=checks)) == 'A wrong name. (observed: none)'
        assert headline(submission(checks=cheap)).startswith('Another id')
        assert headline(submission(checks=again)).startswith('Another id')

    def test_headline_names_a_missing_cell_only_if_that_costs_most(self):
        cell = Problem('y', 'a', 'b', 'c', ('talker',))
        absent = CheckResult('id', 'T', Verdict.FAILED, 0, 1, cause='x', cause_id='missing_file')

        assert headline(submission(checks=(absent, PASSED), problems=(cell,))).startswith('y:')
        assert headline(submission(checks=(absent, failing()), problems=(cell,))) == (
            'a typo (observed: none)'
        )

    def test_headline_says_the_observed_value_once(self):
        long = failing(observed='sensor_id ' + 'x' * 99)

        assert headline(submission(checks=(long,))).endswith('xxx\N{HORIZONTAL ELLIPSIS})')
        assert headline(submission(checks=(failing(observed='typo'),))) == 'a typo'
        assert headline(submission(checks=(failing(cause=''),))) == 'none'


def test_repeated_ids_get_a_number_that_is_free():
    page = '<h3 id="a">x</h3><h3 class="b" id="a">id="a"</h3><p id="a-2"></p><h3 id="a"></h3>'

    assert with_unique_ids(page) == (
        '<h3 id="a">x</h3><h3 class="b" id="a-3">id="a"</h3><p id="a-2"></p><h3 id="a-4"></h3>'
    )
