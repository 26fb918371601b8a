"""What collecting keeps about students: work that was not collected, and display names."""

import re

from collect_sources import (
    CANVAS,
    GOOD,
    laid,
    layout,  # noqa: F401 - a fixture
    LISTEN,
    OTHER,
    packed,
    TALK,
)
from export_world import submission
import pytest
from rich.console import Console

from autograder import __main__ as command
from autograder.classroom.collected import (
    read_collected,
    read_not_collected,
    save_collected,
    Work,
)
from autograder.classroom.pages import print_table, write_all_reports
from autograder.classroom.people import find_student, read_people, student_named
from autograder.classroom.standing import names_for_email, without_result
from autograder.collect.copy_notebooks import collect
from autograder.collect.deliveries import TAKEN, UNCHANGED
from autograder.commands import OK
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.submission.inbox import student_id

PDF = 'no notebook, only essay.pdf'


def kept(layout):
    """Return the saved students, assignments and reasons."""
    return [(one.student, one.assignment, one.why) for one in read_not_collected(layout)]


def test_pdf_and_wrong_lesson_are_kept(tmp_path, layout):
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)

    assert kept(layout) == [
        ('1003', TALK, f'wrong assignment: listen.ipynb belongs to {LISTEN}'),
        ('1004', TALK, PDF),
        ('1006', TALK, 'the student submitted text instead of a file'),
    ]


def test_entry_goes_when_something_of_the_student_arrives(tmp_path, layout):
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)
    later = {'diaz_1004_56004_talk.ipynb': GOOD, 'berg_1002_56002_talk.ipynb': GOOD}
    collect(packed(tmp_path / 'later.zip', later), layout, layout.submitted)
    laid(layout.submitted, {f'1006/{TALK}/talk.ipynb': GOOD})

    assert [student for student, _, _ in kept(layout)] == ['1003']


def test_later_delivery_that_cannot_be_taken_either_replaces_the_reason(tmp_path, layout):
    first = {'diaz_1004_1_essay.pdf': b'%PDF', 'ann_1_2_talk.ipynb': GOOD}
    again = {'diaz_1004_3_listen.ipynb': OTHER, 'ann_1_2_talk.ipynb': GOOD}
    collect(packed(tmp_path / 'a.zip', first), layout, layout.submitted, TALK)
    collect(packed(tmp_path / 'b.zip', again), layout, layout.submitted, TALK)

    assert kept(layout) == [('1004', TALK, f'wrong assignment: listen.ipynb belongs to {LISTEN}')]


@pytest.mark.parametrize('write', [False, True])
def test_dry_run_and_other_folders_keep_nothing(write, tmp_path, layout):
    to = tmp_path / 'elsewhere' if write else layout.submitted
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, to, write=write)

    assert read_not_collected(layout) == ()


def test_collecting_in_another_folder_leaves_the_list(tmp_path, layout):
    """The names and places of the collected work are saved, because it may be graded there."""
    save_collected(layout, [Work('1001', TALK, why=PDF)])

    collect(packed(tmp_path / 'c.zip', CANVAS), layout, tmp_path / 'elsewhere')

    assert kept(layout) == [('1001', TALK, PDF)]
    assert {one.student for one in read_collected(layout) if one.place} == {'1001', '1002', '1005'}


def test_delivery_of_no_certain_assignment_is_missing_in_each(tmp_path, layout):
    collect(laid(tmp_path / 's', {'ann/essay.pdf': b'%PDF'}), layout, layout.submitted)

    for assignment in (TALK, LISTEN):
        (one,) = without_result(layout, assignment, [submission('bob')])
        assert (one.student, one.reason) == ('ann', f'Not collected: {PDF}.')
    assert without_result(layout, TALK, [submission('ann')]) == ()


@pytest.mark.parametrize(
    'damage',
    [
        b'',
        b'{',
        b'null',
        b'{"a": 1}',
        b'[1]',
        b'[{}]',
        b'[{"student": 1}]',
        b'[{"student": "ann", "numbers": "1"}]',
        b'\xff\xfe',
        b'[' * 100_000,
    ],
)
def test_damaged_file_is_one_sentence(damage, layout, tmp_path):
    """Without the saved numbers, two people could become one, so collecting stops."""
    laid(layout.work, {layout.collected.name: damage})
    source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD})

    for act in (
        lambda: collect(source, layout, layout.submitted),
        lambda: without_result(layout, TALK, ()),
        lambda: save_collected(layout, [Work('ann')]),
    ):
        with pytest.raises(GraderError, match=r'collected\.json: .* Try: delete the file'):
            act()
    assert layout.collected.read_bytes() == damage
    assert not layout.submitted.exists()


class TestShown:
    @pytest.fixture
    def missing(self, layout):
        """Return two deliveries, one of them with a name that contains markup."""
        save_collected(
            layout,
            [
                Work('bob', TALK, why='no file that can be read'),
                Work('1001', TALK, 'Ann <b>', why=PDF, handed_in='2026-03-01 12:00'),
            ],
        )
        return read_not_collected(layout)

    def test_page_has_reasons_and_names(self, missing, layout):
        write_all_reports(layout, TALK, [submission('cho')])

        text = (layout.reports / TALK / 'class.html').read_text('utf-8')
        assert f'Not collected: {PDF} (handed in 2026-03-01 12:00 UTC).' in text
        assert 'For an e-mail: Ann &lt;b&gt;, bob</p>' in text

    def test_table_has_a_row_for_each(self, missing, layout):
        console = Console(record=True, width=120, file=None)
        rows = without_result(layout, TALK, [submission('cho')])
        print_table(console, TALK, [submission('cho')], {}, rows)
        text = console.export_text()

        assert '1001 (Ann <b>)' in text
        assert 'nothing' in text
        assert 'no file that can be read' in text

    def test_collect_prints_the_names_of_all_that_are_missing(
        self, missing, tmp_path, layout, monkeypatch, capsys
    ):
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))
        source = laid(tmp_path / 's', {'cho/talk.ipynb': GOOD})
        save_collected(layout, [Work('dan', why=PDF)])

        assert command.main(['collect', str(source)]) == OK
        assert capsys.readouterr().out.endswith(
            f'Nothing to grade yet for an unknown lesson from: dan\n'
            f'Nothing to grade yet for {TALK} from: Ann <b>, bob\n'
        )

    def test_a_student_is_named_once(self):
        two = [Work('ann', TALK, why=PDF), Work('ann', LISTEN, why=PDF)]

        assert names_for_email(two) == 'ann'


NAMED = {'exampleann_1001_55001_talk.ipynb': GOOD, 'berg_1002_55002_essay.pdf': b'%PDF'}


def test_names_of_what_was_taken_are_kept(tmp_path, layout):
    collect(packed(tmp_path / 'c.zip', NAMED), layout, layout.submitted)
    assert read_people(layout) == {'1001': 'exampleann'}

    text = b'submission_1:\n  :submitters:\n  - :name: "Ann \xc3\x89xample"\n    :sid: \'1001\'\n'
    metadata = text + b'submission_2:\n  :submitters:\n  - :name: Bo\n    :email: b@x.org\n'
    files = {
        'submission_metadata.yml': metadata,
        'submission_1/talk.ipynb': GOOD,
        'submission_2/talk.ipynb': GOOD,
    }
    rows = collect(packed(tmp_path / 'g.zip', files), layout, layout.submitted)

    assert [row.done for row in rows] == [UNCHANGED, TAKEN]
    assert read_people(layout) == {'1001': 'Ann Éxample', 'b@x.org': 'Bo'}
    assert 'Éxample' in layout.collected.read_text(encoding='utf-8')


def test_latest_name_of_a_student_counts(layout):
    save_collected(layout, [Work('1', TALK, 'exampleann'), Work('1', LISTEN, 'exampleann')])
    save_collected(layout, [Work('1', TALK, 'Ann Example')])
    save_collected(layout, [Work('1', LISTEN), Work('2', TALK, 'not collected', why='a PDF')])

    assert read_people(layout) == {'1': 'Ann Example'}


def test_moodle_names_are_kept_only_if_the_id_is_another(tmp_path, layout):
    place = '{}_assignsubmission_file/talk.ipynb'
    files = {place.format(who): GOOD for who in ("Bo O'Neil_1", 'Ann_2')}

    collect(packed(tmp_path / 'm.zip', files), layout, layout.submitted)

    assert read_people(layout) == {student_id("Bo O'Neil"): "Bo O'Neil"}


def test_a_dry_run_and_a_repeated_run_write_no_names(tmp_path, layout):
    source = packed(tmp_path / 'c.zip', NAMED)
    collect(source, layout, layout.submitted, write=False)
    assert not layout.collected.exists()

    collect(source, layout, layout.submitted)
    before = layout.collected.stat()
    collect(source, layout, layout.submitted)
    assert layout.collected.stat().st_ino == before.st_ino


def test_names_are_text_of_one_line(layout):
    names = {
        '1': 'Ann\x1b[31m\n Ex\u202eample\x00',
        '2': 'x' * 999,
        '3': '\x07',
        '4': 'می\u200cخواهم \ud800',
    }
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert read_people(layout) == {
        '1': 'Ann[31m Example',
        '2': 'x' * 200,
        '4': 'می\u200cخواهم',
    }


@pytest.mark.parametrize(
    ('name', 'student'),
    [('1001', '1001'), ('Ann Lee', '1001'), ('  ann   LEE ', '1001'), ('Bo', 'Bo')],
)
def test_student_is_found_by_id_or_name(name, student, layout):
    names = {'1001': 'Ann Lee', '1002': 'Bo', '1003': 'Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert student_named(layout, name, {'1001', '1002', 'Bo'}) == student


def test_a_name_of_several_students_is_refused_and_an_unknown_one_is_nobody(layout):
    names = {'1001': 'Ann Lee', '1002': 'Ann  Lee', '9': 'Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])
    students = {'1001', '1002', '1003'}

    with pytest.raises(
        GraderError, match=r'2 students have this name\. Try: use one of the ids 1001, 1002'
    ):
        student_named(layout, 'Ann Lee', students)
    assert [student_named(layout, name, students) for name in ('Zoe', '', 'Gone')] == [''] * 3


@pytest.mark.parametrize(
    ('name', 'said'),
    [
        ('Clara Ivanof', 'Did you mean "Clara Ivanov"?'),
        ('Ivanov', 'Did you mean "Clara Ivanov"?'),
        ('Katrin Garcia', 'Did you mean "Katrin García"?'),
        ('1011', 'Did you mean 1001?'),
        ('Zoe', 'Try: the id, or the full name in quotes'),
    ],
)
def test_an_unknown_student_is_refused_with_similar_names(layout, name, said):
    names = {'1001': 'Clara Ivanov', '2': 'Katrin García', '3': 'Clara Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert find_student(layout, 'clara ivanov', {'1001', '2'}) == '1001'
    with pytest.raises(GraderError, match=f'{name}: there is no such student. {re.escape(said)}'):
        find_student(layout, name, {'1001', '2'})
