"""Statistics of a class: the numbers, the page, and the text on the terminal."""

from dataclasses import replace
from itertools import pairwise
import json
from pathlib import Path

from bs4 import BeautifulSoup
from collect_sources import laid
from export_world import check, CLASS, EVIL, failed, FULL, REVIEW, submission, VISIBLE
from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.collected import save_collected, Work
from autograder.classroom.pages import write_all_reports, write_class_report
from autograder.classroom.results_of_class import ClassResults, graded
from autograder.classroom.standing import standings
from autograder.classroom.statistics import class_numbers
from autograder.commands.explain import verdicts_text
from autograder.commands.stats import stats_text
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.results import Problem

LOADS = ('src', 'srcset', 'data', 'poster', 'action', 'xlink:href')
ASSIGNMENT = '01_talker'


def numbers_of(*results, root='/nowhere'):
    return class_numbers(Layout(Path(root)), ClassResults(ASSIGNMENT, results))


def page_of(root, *results, summary=''):
    made = ClassResults(ASSIGNMENT, tuple(results))
    return write_class_report(Layout(root), made, summary).read_text('utf-8')


def timed(student, **timing):
    """Return a submission with one exam and this timing."""
    one = submission(student)
    return replace(one, exams=(replace(one.exams[0], timing=timing),))


def with_headers(root, *headers):
    """Return the results of a class whose recordings have these headers."""
    results = []
    for number, header in enumerate(headers):
        name = f'{number}.jsonl'
        recording = f'{json.dumps(header)}\nnonsense'.encode()
        laid(Layout(root).recordings / 'talker', {name: recording})
        one = submission(f's{number}')
        results.append(replace(one, exams=(replace(one.exams[0], recording=name),)))
    return results


def with_points(*points):
    """Return submissions with these points out of ten."""
    return [
        submission(f's{number}', (check('runs', points=one, most=10.0),))
        for number, one in enumerate(points)
    ]


@pytest.fixture
def layout(tmp_path):
    """Return a course with one released assignment that was graded."""
    made = Layout(laid(tmp_path, {f'notebooks/{ASSIGNMENT}/talker.ipynb': b'{}'}))
    write_all_reports(made, ASSIGNMENT, CLASS.results[:3])
    return made


def read(page):
    return BeautifulSoup(page, 'html.parser')


class TestNumbers:
    def test_marks_are_summed_up(self):
        """Each bin is a tenth of the points, and full marks are in the last bin."""
        marks = numbers_of(*with_points(0, 1, 4.99, 5, 9, 10)).marks

        assert (marks.count, marks.lowest, marks.highest, marks.full) == (6, 0, 10, 1)
        assert marks.mean == pytest.approx(4.998, abs=0.001)
        assert marks.median == pytest.approx(4.995)
        assert marks.bins == (1, 1, 0, 0, 1, 1, 0, 0, 0, 2)

    def test_quartiles_of_a_single_submission_equal_its_mark(self):
        marks = numbers_of(*with_points(7)).marks

        assert (marks.lower_quartile, marks.median, marks.upper_quartile) == (7, 7, 7)

    def test_for_review_counts_nowhere_but_in_its_list(self):
        numbers = numbers_of(FULL, REVIEW)

        assert numbers.marks.count == 1
        assert numbers.marks.lowest == 5.0
        assert {one.failed for one in numbers.checks} == {0}
        assert numbers.review == (('eve', 'The probe broke off. Grade it again.'),)

    def test_class_with_only_submissions_for_review_has_no_marks(self):
        numbers = numbers_of(REVIEW)

        assert numbers.marks is None
        assert 'no student has a mark' in stats_text(numbers)

    def test_causes_are_counted_by_their_name(self):
        others = [submission(f's{n}', (failed(words=f'a typo in line {n}'),)) for n in range(2)]
        same = [submission(f't{n}', (failed(words='a typo in line 1'),)) for n in range(2)]
        odd = submission('u', (failed(words='late', cause_id='late'),))
        (numbers,) = numbers_of(*others, *same, odd).checks

        assert numbers.causes == (('a typo in line 1', 4), ('late', 1))
        assert (numbers.passed, numbers.failed, numbers.not_run) == (0, 5, 0)

    def test_digests_come_from_the_recordings_that_are_there(self, tmp_path):
        """A missing or damaged recording has no digest and is not an error."""
        (made,) = with_headers(tmp_path, {'scenario': 'a' * 32, 'environment': 'b' * 32})

        assert numbers_of(made, root=tmp_path).exams == {
            'talker': {'scenario': ('a' * 12,), 'environment': ('b' * 12,)}
        }
        (Layout(tmp_path).recordings / 'talker' / '0.jsonl').write_text('{', encoding='utf-8')
        assert numbers_of(made, root=tmp_path).exams['talker'] == {
            'scenario': (),
            'environment': (),
        }

    @pytest.mark.parametrize(
        ('headers', 'versions', 'said'),
        [
            # All versions are listed; older recordings name only an environment.
            (
                [
                    {'environment': 'b' * 32, 'made_with': {'grader': '79c8bf8', 'python': '3.9'}},
                    {'environment': 'b' * 32, 'made_with': {'grader': '523d5a5', 'python': '3.9'}},
                    {'environment': 'c' * 32},
                ],
                {
                    'grader': '79c8bf8 and 523d5a5',
                    'python': '3.9',
                    'environment': f'{"b" * 12} and {"c" * 12}',
                },
                'ecorded with grader 79c8bf8 and 523d5a5, python 3.9',
            ),
            ([{'made_with': 'nonsense'}, {'made_with': {'python': 3}}], {'python': '3'}, 'python'),
            # Without recordings, the versions of this machine are not shown.
            ([], {}, ''),
        ],
        ids=['versions', 'damaged', 'no recordings'],
    )
    def test_versions_are_those_of_the_recordings(self, tmp_path, headers, versions, said):
        results = with_headers(tmp_path, *headers) or [FULL]
        numbers = numbers_of(*results, root=tmp_path)
        page = read(page_of(tmp_path, *results)).text

        assert numbers.versions == versions
        for text in (stats_text(numbers), page):
            assert said in text
            assert ('ecorded with' in text) is bool(said)

    def test_the_slowest_come_first_and_the_recorded_are_counted(self):
        """A submission that was not run has no time."""
        numbers = numbers_of(submission('a'), submission('b'), timed('c', run_s=2.0))

        assert numbers.slowest == (('c', 2.0), ('a', 1.25), ('b', 1.25))
        assert numbers.recorded == 0

    def test_the_slowest_are_the_same_after_a_rerun(self):
        """The time for judging does not count, and an old recording has no time."""
        first = numbers_of(timed('a', run_s=1.0), timed('b', run_s=2.0))
        again = numbers_of(
            timed('a', kept_run_s=1.0, judge_s=5.0), timed('b', kept_run_s=2.0), timed('c')
        )

        assert again.slowest == first.slowest == (('b', 2.0), ('a', 1.0))
        assert (first.recorded, again.recorded) == (0, 3)

    @settings(deadline=None, max_examples=40)
    @given(strategies.lists(strategies.floats(0, 10), min_size=1, max_size=30))
    def test_everyone_is_in_one_bin(self, points):
        marks = numbers_of(*with_points(*points)).marks

        assert sum(marks.bins) == len(points)
        assert marks.lowest <= marks.lower_quartile <= marks.median <= marks.highest


class TestPage:
    def test_it_loads_nothing_and_runs_nothing(self, tmp_path):
        page = page_of(tmp_path, *CLASS.results, summary=EVIL)
        parts = read(page)

        assert not parts(['script', 'link', 'img', 'iframe', 'object', 'embed', 'form'])
        for part in parts(True):
            assert not set(part.attrs) & set(LOADS)
            assert not [name for name in part.attrs if name.startswith('on')]
            link = part.get('href') or ''
            assert not link or link.startswith(('#', 'students/'))
        assert 'url(' not in page
        assert '@import' not in page
        assert '\x1b' not in page

    def test_for_review_comes_first_with_the_reason(self, tmp_path):
        text = read(page_of(tmp_path, *CLASS.results)).text

        assert text.index('The probe broke off') < text.index('Marks')
        assert text.rindex('eve') < text.rindex('ann')

    def test_unusable_work_is_for_review_and_first_in_what_is_worth_a_look(self, layout):
        cut = Problem('x.ipynb', 'a notebook', 'an empty file', 'submit again', ('talker',), True)
        results = [submission('ann', noticed=('odd cells',)), submission('zoe', problems=(cut,))]
        numbers = numbers_of(*results)
        text = read(page_of(layout.root, *results)).text

        assert numbers.review == (('zoe', cut.line()),)
        said = verdicts_text([(ASSIGNMENT, one) for one in standings(layout, ASSIGNMENT, results)])
        assert f'zoe, {ASSIGNMENT}: for review: {cut.line()}'[:60] in said
        assert said.count('talker/runs') == 1
        assert numbers.marks.count == 1
        look = text.index('Worth a look')
        assert look < text.index(cut.got, look) < text.index('odd cells')

    def test_every_student_is_linked_to_a_page_that_is_there(self, layout):
        path = write_class_report(layout, graded(layout, ASSIGNMENT)[0])

        links = {one['href'] for one in read(path.read_text('utf-8'))('a')}
        assert '#everybody' in links
        assert len(links) == 4
        for link in links - {'#everybody'}:
            assert (path.parent / link).is_file(), link

    def test_the_picture_is_also_a_table(self, tmp_path):
        parts = read(page_of(tmp_path, *with_points(0, 5, 10, 10)))

        (svg,) = parts('svg')
        identifiers = {part['id'] for part in parts(id=True)}
        assert svg['role'] == 'img'
        assert set(svg['aria-labelledby'].split()) <= identifiers
        assert '0 to below 1: 1, 5 to below 6: 1, 9 to 10: 2.' in parts.text

    def test_checks_stand_in_the_order_of_the_exams(self, tmp_path):
        first, second = submission(exam='z'), submission(exam='a')
        both = type(first)('ann', ASSIGNMENT, (*first.exams, *second.exams))
        text = read(page_of(tmp_path, both)).text

        assert text.index('Z') < text.index('It runs.') < text.rindex('It runs.')
        assert '1 of 1: a typo' in text

    def test_headings_do_not_skip_a_level(self, tmp_path):
        page = page_of(tmp_path, *CLASS.results)
        levels = [int(one.name[1]) for one in read(page)(['h1', 'h2', 'h3'])]

        assert levels[0] == 1
        assert levels.count(1) == 1
        assert all(two <= one + 1 for one, two in pairwise(levels))

    def test_it_is_written_again_in_place(self, layout):
        for summary in ('first', 'second'):
            path = write_class_report(layout, graded(layout, ASSIGNMENT)[0], summary)

        assert 'second' in path.read_text('utf-8')
        assert [one.name for one in path.parent.glob('.class*')] == []


class TestTerminal:
    def test_it_says_the_same_in_words(self):
        text = stats_text(numbers_of(submission(), FULL, REVIEW))

        for part in (
            '01_talker: 3 submissions',
            'for review: eve: The probe broke off.',
            'mean 3.5, median 3.5',
            'talker/warns',
            '1 of 1: a typo',
            'flag: ann: odd',
            'slowest: ann: 1.2 s',
            'isolation bwrap-user',
        ):
            assert part in text

    def test_hostile_words_have_no_effect_on_a_terminal(self):
        assert '\x1b' not in stats_text(numbers_of(*CLASS.results))


class TestWhatWasGraded:
    def test_an_assignment_may_be_named_without_its_number(self, layout):
        for name in ('talker', '01', '1'):
            assert layout.assignment_named(name) == ASSIGNMENT
        assert graded(layout, 'talker')[0].results == CLASS.results[:3]

    def test_a_typo_is_answered_with_a_near_one_and_nothing_graded_with_what_to_do(self, layout):
        with pytest.raises(GraderError, match='Did you mean 01_talker'):
            layout.assignment_named('01_taker')
        with pytest.raises(GraderError, match='Try: make grade'):
            graded(Layout(layout.root / 'nothing'))


def test_visible_checks_alone_make_no_marks(tmp_path):
    """Isolation that cannot hide the hidden exams leaves only the visible checks."""
    numbers = numbers_of(VISIBLE)

    assert numbers.marks is None
    assert [check.passed for check in numbers.checks] == [1, 1]
    page = page_of(tmp_path, VISIBLE)
    assert '>5 of 5<br><span class="review">only visible checks</span>' in page


def test_names_are_with_their_ids(tmp_path):
    """Names are shown next to ids, for platforms whose ids are numbers."""
    save_collected(Layout(tmp_path), [Work('eve', person='Eve Example')])
    page = page_of(tmp_path, *CLASS.results)

    assert page.count('eve (Eve Example)</a>') == page.count('>eve') > 1
