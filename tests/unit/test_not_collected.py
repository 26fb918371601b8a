"""Work that could not be collected stays in the reports until other work is collected."""

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
from autograder.classroom.standing import names_for_email, without_result
from autograder.collect.copy_notebooks import collect
from autograder.commands import OK
from autograder.errors import GraderError
from autograder.layout import Layout

PDF = 'no notebook, only essay.pdf'


def kept(layout):
    """Return the saved students, assignments and reasons."""
    return [(one.student, one.assignment, one.why) for one in read_not_collected(layout)]


def test_pdf_and_wrong_lesson_are_kept(tmp_path, layout):
    """A student whose notebook was collected is not in the list."""
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)

    assert kept(layout) == [
        ('1003', TALK, f'wrong assignment: listen.ipynb belongs to {LISTEN}'),
        ('1004', TALK, PDF),
        ('1006', TALK, 'the student submitted text instead of a file'),
    ]


def test_entry_goes_when_something_of_the_student_arrives(tmp_path, layout):
    """The new work may be collected, or copied to the folder by hand."""
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)
    later = {'diaz_1004_56004_talk.ipynb': GOOD, 'berg_1002_56002_talk.ipynb': GOOD}
    collect(packed(tmp_path / 'later.zip', later), layout, layout.submitted)
    laid(layout.submitted, {f'1006/{TALK}/talk.ipynb': GOOD})

    assert [student for student, _, _ in kept(layout)] == ['1003']


def test_later_delivery_that_cannot_be_taken_either_replaces_the_reason(tmp_path, layout):
    """The student needs to know the latest reason."""
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
    """The list is shown in the pages, and in the tables of grade and collect."""

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
        """The names are in one place, so that they can be copied into an e-mail."""
        write_all_reports(layout, TALK, [submission('cho')])

        text = (layout.reports / TALK / 'class.html').read_text('utf-8')
        assert f'Not collected: {PDF} (handed in 2026-03-01 12:00 UTC).' in text
        assert 'Nothing to grade yet from: Ann &lt;b&gt;, bob</p>' in text

    def test_table_has_a_row_for_each(self, missing, layout):
        """The rows of missing students follow those with points."""
        console = Console(record=True, width=120, file=None)
        rows = without_result(layout, TALK, [submission('cho')])
        print_table(console, TALK, [submission('cho')], {}, rows)
        text = console.export_text()

        assert '1001 (Ann <b>)' in text
        assert 'nothing' in text
        assert 'Nothing to grade yet from: Ann <b>, bob' in text

    def test_collect_prints_the_names_of_all_that_are_missing(
        self, missing, tmp_path, layout, monkeypatch, capsys
    ):
        """Students of earlier collections are named too."""
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))
        source = laid(tmp_path / 's', {'cho/talk.ipynb': GOOD})

        assert command.main(['collect', str(source)]) == OK
        assert capsys.readouterr().out.endswith('Nothing to grade yet from: Ann <b>, bob\n')

    def test_a_student_is_named_once(self):
        two = [Work('ann', TALK, why=PDF), Work('ann', LISTEN, why=PDF)]

        assert names_for_email(two) == 'ann'
