"""Collect valid and invalid sources of each kind for nbgrader, and report them in a table."""

import os
import stat
import zipfile

from collect_sources import (
    CANVAS,
    collect,
    EXCHANGE,
    GOOD,
    GRADESCOPE,
    laid,
    layout,  # noqa: F401 - a fixture
    limit,
    LISTEN,
    MOODLE,
    notebook,
    packed,
    REPOSITORIES,
    taken,
    TALK,
)
import pytest

from autograder import __main__ as command
from autograder.classroom.collected import read_not_collected
from autograder.classroom.course_lock import lock_course
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import last_results, results_file
from autograder.collect.recognise import recognise_platform
from autograder.collect.source.deliveries import BOUNDS
from autograder.collect.table import LEFT, REPLACED, TAKEN, UNCHANGED
from autograder.commands import FOR_REVIEW, OK
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.ids import student_id
from autograder.submission.inbox import discover, is_student_id
from autograder.submission.tree import opened, UnusableUploadError


@pytest.mark.parametrize(
    ('files', 'kind'),
    [
        (CANVAS, 'canvas'),
        (MOODLE, 'moodle'),
        (GRADESCOPE, 'gradescope'),
        (EXCHANGE, 'exchange'),
        (REPOSITORIES, 'folder'),
    ],
    ids=['canvas', 'moodle', 'gradescope', 'exchange', 'repositories'],
)
@pytest.mark.parametrize('how', [packed, laid])
class TestEveryKind:
    """Each source is read as a zip and as an unpacked folder."""

    def test_it_is_recognised(self, files, kind, how, tmp_path):
        with opened(how(tmp_path / 'source.zip', files), BOUNDS) as found:
            assert recognise_platform(found) == kind

    def test_the_source_stays_as_it_is_and_a_second_time_changes_nothing(
        self, files, kind, how, tmp_path, layout
    ):
        source = how(tmp_path / 'source.zip', files)
        before = sorted((str(path), path.stat().st_mtime_ns) for path in source.rglob('*'))
        collect(source, layout, layout.submitted)
        first = taken(layout)

        again = collect(source, layout, layout.submitted)

        assert first
        assert taken(layout) == first
        assert {row.done for row in again} <= {UNCHANGED, LEFT}
        assert before == sorted((str(path), path.stat().st_mtime_ns) for path in source.rglob('*'))


def test_what_was_collected_can_be_graded(tmp_path, layout):
    """Nbgrader can read all ids, including those made from names in other alphabets."""
    files = {
        'Zoë Ünal/talk.ipynb': GOOD,
        '李雷/talk.ipynb': GOOD,
        'अमित/talk.ipynb': GOOD,
        'अमीत/talk.ipynb': GOOD,
        'a,b;c*/talk.ipynb': GOOD,
        '--/talk.ipynb': GOOD,
    }
    rows = collect(laid(tmp_path / 's', files), layout, layout.submitted)

    found = discover(layout.submitted, TALK, 'talk.ipynb', layout.assignments())
    assert [one.student for one in found] == [
        'Zoë Ünal', 'a_b_c--3923e48481b1', 'अमित', 'अमीत', '李雷'
    ]  # fmt: skip
    assert all(one.recordable and not one.problems for one in found)
    assert ('no letter or digit in the name', "the name was '--'") in [row.notes for row in rows]


def test_two_names_that_become_one_are_both_left(tmp_path, layout):
    """If two names give one id, neither is collected: no student gets another's marks."""
    files = {'ann/talk.ipynb': GOOD, 'hw-ann/talk.ipynb': GOOD}

    rows = collect(laid(tmp_path / 's', files), layout, layout.submitted, prefix='hw-')

    assert [row.done for row in rows] == [LEFT, LEFT]
    assert all("names give one student id: 'ann', 'hw-ann'" in row.notes[0] for row in rows)


class TestStudentIds:
    """A name gives the same id on every day and from every source."""

    @pytest.mark.parametrize(
        'name', ['ann', 'Ann Example', 'smith-john', '_x', 'b.c', 'bo@x.org', '2024-0001', 'Ünal']
    )
    def test_what_can_be_an_id_is_one(self, name):
        assert student_id(name) == name

    def test_no_two_names_become_one(self):
        """Names that differ only in punctuation or vowel signs, for example, get different ids."""
        names = ['a,b', 'a;b', 'a_b', 'a_b,', 'अमित', 'अमीत', 'x' * 101, 'x' * 102, ' ann', 'ann']
        names += ['می\u200cخواهم', 'میخواهم', 'O’Neil', "O'Neil", 'O_Neil', student_id('a,b')]

        ids = [student_id(name) for name in names]

        assert len(set(ids)) == len(names)
        assert all(is_student_id(one) for one in ids)

    def test_two_ways_to_write_a_letter_are_one(self):
        """A letter with a combining accent gives the same id as the precomposed letter."""
        assert student_id('Zoe\u0308') == student_id('Zo\xeb') == 'Zo\xeb'

    @pytest.mark.parametrize('name', ['Zoë', 'Zoe\u0308', '小明', 'Jose--x'])
    def test_one_from_a_zip_that_does_not_say_utf_8(self, name, tmp_path, layout):
        """A zip without the UTF-8 flag, as macOS's Finder writes it, gives the same ids."""
        source = packed(tmp_path / 's.zip', {f'{name}/talk.ipynb': GOOD})
        data = source.read_bytes()
        for header, flags in ((b'PK\x03\x04', 6), (b'PK\x01\x02', 8)):
            at = data.index(header) + flags
            data = data[:at] + b'\0\0' + data[at + 2 :]
        source.write_bytes(data)

        collect(source, layout, layout.submitted)

        assert set(taken(layout)) == {f'{student_id(name)}/{TALK}/talk.ipynb'}

    @pytest.mark.parametrize('name', ['', '--', '***', '_', '\u093f', ' . '])
    def test_a_name_without_a_letter_or_digit_is_none(self, name):
        """A name without letters and digits is refused, because a person has to choose its id."""
        assert student_id(name) == ''


class TestHostileSources:
    """Names and sizes that an attacker has chosen."""

    @pytest.mark.parametrize(
        ('name', 'why'),
        [
            ('../../evil/talk.ipynb', 'a path that leads out of the folder'),
            ('/etc/talk.ipynb', 'an absolute path'),
            ('C:/x/talk.ipynb', 'an absolute path'),
            ('a\\..\\talk.ipynb', 'a name with unprintable characters'),
            ('a/\x1b[31m/talk.ipynb', 'a name with unprintable characters'),
        ],
    )
    def test_a_path_that_leads_elsewhere_is_left(self, name, why, tmp_path, layout):
        source = packed(tmp_path / 's.zip', {name: GOOD, 'ann/talk.ipynb': GOOD, 'b/x.txt': b''})

        rows = collect(source, layout, layout.submitted)

        assert (LEFT, (why,)) in [(row.done, row.notes) for row in rows]
        assert set(taken(layout)) == {f'ann/{TALK}/talk.ipynb'}

    def test_a_link_in_a_zip_is_left(self, tmp_path, layout):
        link = zipfile.ZipInfo('ann/talk.ipynb')
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        with zipfile.ZipFile(tmp_path / 's.zip', 'w') as archive:
            archive.writestr(link, '/etc/passwd')

        rows = collect(tmp_path / 's.zip', layout, layout.submitted)

        assert [(row.student, row.done, row.notes) for row in rows] == [
            ('', LEFT, ('a link or a special file',)),
            ('ann', LEFT, ('no file that can be read',)),
        ]
        assert [one.student for one in read_not_collected(layout)] == ['ann']

    def test_links_and_pipes_in_a_folder_are_left(self, tmp_path, layout):
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD})
        (source / 'bob').mkdir()
        (source / 'bob' / 'talk.ipynb').symlink_to(source / 'ann' / 'talk.ipynb')
        os.mkfifo(source / 'pipe')
        (source / 'loop').symlink_to(source)

        rows = collect(source, layout, layout.submitted)

        left = {row.place: row.notes[0] for row in rows if row.done == LEFT}
        assert left.pop('bob') == 'no file that can be read'
        assert left == dict.fromkeys(
            ('bob/talk.ipynb', 'loop', 'pipe'), 'a link or a special file'
        )
        assert set(taken(layout)) == {f'ann/{TALK}/talk.ipynb'}

    def test_a_file_that_grows_when_unpacked_is_bounded(self, tmp_path, layout, monkeypatch):
        """The number of unpacked bytes is limited, whatever size the zip states."""
        limit(monkeypatch, file_bytes=1000)
        source = packed(tmp_path / 's.zip', {'ann/talk.ipynb': b' ' * 100_000})

        (row,) = collect(source, layout, layout.submitted)

        assert row.done == LEFT
        assert 'more than' in row.notes[0]

    def test_far_too_many_files_are_refused_as_a_whole(self, tmp_path, layout, monkeypatch):
        limit(monkeypatch, entries=2)
        source = laid(tmp_path / 's', {f'{name}/talk.ipynb': GOOD for name in 'abc'})

        with pytest.raises(UnusableUploadError, match='more than 2 files'):
            collect(source, layout, layout.submitted)

    @pytest.mark.parametrize('how', [packed, laid])
    def test_generated_files_do_not_count_towards_the_size_limit(
        self, how, tmp_path, layout, monkeypatch
    ):
        work = ('src/ros_ws/build/x', 'install/COLCON_IGNORE', 'install/x.ipynb', '.venv/a/x.py')
        files = {f'{name}/{file}': GOOD for name in ('ann', 'bob') for file in work}
        files |= {'ann/talk.ipynb': GOOD, 'ann/build/notes.txt': b'', 'cy/log/talk.ipynb': GOOD}
        source = how(tmp_path / 's', files)
        limit(monkeypatch, entries=12)

        rows = collect(source, layout, layout.submitted)

        assert [(row.student, row.done) for row in rows] == [
            ('ann', TAKEN), ('bob', LEFT), ('cy', TAKEN)
        ]  # fmt: skip
        assert rows[1].notes == ('no file that can be read',)
        limit(monkeypatch, listed=5)
        with pytest.raises(UnusableUploadError, match='more than 5 files'):
            collect(source, layout, layout.submitted)

    @pytest.mark.parametrize('name', ['build', 'install', 'log'])
    def test_a_students_own_folder_is_no_programs(self, name, tmp_path, layout):
        files = {f'{name}/COLCON_IGNORE': b'', f'{name}/talk.ipynb': GOOD, 'ann/talk.ipynb': GOOD}

        rows = collect(laid(tmp_path / 's', files), layout, layout.submitted)

        assert {row.student: row.done for row in rows} == {'ann': TAKEN, name: TAKEN}

    def test_a_name_of_very_many_slashes_is_left(self, tmp_path, layout):
        name = 'ann/' + 'x/' * 30_000 + 'talk.ipynb'

        (row,) = collect(packed(tmp_path / 's.zip', {name: GOOD}), layout, layout.submitted)

        assert (row.done, row.notes) == (LEFT, ('a path that is far too long',))

    def test_metadata_that_is_no_table_is_one_sentence(self, tmp_path, layout):
        """YAML in a source creates no objects."""
        text = b'!!python/object/apply:os.system ["touch /tmp/evil"]'
        source = laid(tmp_path / 's', {'submission_metadata.yml': text, 'a/b.ipynb': GOOD})

        with pytest.raises(UnusableUploadError, match='not valid YAML'):
            collect(source, layout, layout.submitted)

    def test_a_damaged_zip_is_one_sentence(self, tmp_path, layout):
        (tmp_path / 's.zip').write_bytes(packed(tmp_path / 'g.zip', MOODLE).read_bytes()[:200])

        with pytest.raises(UnusableUploadError, match='the zip file cannot be read'):
            collect(tmp_path / 's.zip', layout, layout.submitted)


def test_work_that_was_handed_in_again_replaces_the_old_one(tmp_path, layout):
    collect(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}), layout, layout.submitted)
    newer = notebook('talker', text='newer')
    laid(tmp_path / 's', {'ann/talk.ipynb': newer})

    (row,) = collect(tmp_path / 's', layout, layout.submitted)

    assert row.done == REPLACED
    assert taken(layout) == {f'ann/{TALK}/talk.ipynb': newer}


def test_a_folder_that_is_a_link_is_not_written_through(tmp_path, layout):
    layout.submitted.mkdir(parents=True)
    (tmp_path / 'elsewhere').mkdir()
    (layout.submitted / 'ann').symlink_to(tmp_path / 'elsewhere')

    (row,) = collect(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}), layout, layout.submitted)

    assert row.done == LEFT
    assert list((tmp_path / 'elsewhere').iterdir()) == []


class TestCommand:
    @pytest.fixture(autouse=True)
    def here(self, layout, monkeypatch):
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))

    def test_it_prints_a_table_and_tells_by_its_exit_code(self, tmp_path, layout, capsys):
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD, 'bob/x.txt': b''})

        assert command.main(['collect', str(source)]) == FOR_REVIEW
        said = capsys.readouterr().out
        assert 'no notebook, only x.txt' in said
        assert '1 not taken, 1 taken.' in said

    def test_a_dry_run_writes_nothing(self, tmp_path, layout, capsys):
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD})

        assert command.main(['collect', str(source), '--dry-run']) == OK
        said = capsys.readouterr().out
        assert 'ann' in said
        assert '1 taken. Nothing was written (--dry-run).' in said
        assert not layout.submitted.exists()

    def test_the_example_students_leave_when_a_class_comes(self, tmp_path, layout, capsys):
        laid(layout.sample_class, {f'{TALK}/pass__example/expected.json': b'{}'})
        example = laid(layout.submitted, {f'pass__example/{TALK}/talk.ipynb': GOOD})
        everybody = [SubmissionResult(one, TALK) for one in ('ann', 'pass__example')]
        write_all_reports(layout, TALK, everybody)
        write_all_reports(layout, LISTEN, everybody[1:])
        empty = laid(tmp_path / 'empty', {'ann/x.txt': b''})
        settings = f"c.CourseDirectory.db_url = 'sqlite:///{tmp_path}/none.db'\n"
        (layout.root / 'nbgrader_config.py').write_text(f'c = get_config()\n{settings}', 'utf-8')

        command.main(['collect', str(empty)])
        assert (example / 'pass__example').is_dir()

        source = str(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}))
        named_otherwise = layout.submitted / '..' / layout.submitted.name
        command.main(['collect', source, '--to', str(named_otherwise)])
        assert [path.name for path in layout.submitted.iterdir()] == ['ann']
        assert [one.student for one in last_results(layout, TALK)] == ['ann']
        assert not results_file(layout, LISTEN).exists()
        assert 'Removed the 1 example students' in capsys.readouterr().err

    def test_it_waits_for_no_grading(self, tmp_path, layout, capsys):
        source = str(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}))

        with lock_course(layout, 'a grading'):
            assert command.main(['collect', source]) == command.USAGE
            assert 'this course: a grading since' in capsys.readouterr().err
            assert command.main(['collect', source, '--dry-run']) == OK
        assert not layout.submitted.exists()
        assert command.main(['collect', source]) == OK

    def test_a_prefix_is_taken_off(self, tmp_path, layout, capsys):
        source = laid(tmp_path / 's', {'hw1-ann/talk.ipynb': GOOD, 'bob/talk.ipynb': GOOD})

        assert command.main(['collect', str(source), '--prefix', 'hw1-']) == OK
        said = capsys.readouterr().out
        (ann,) = [line for line in said.splitlines() if 'hw1-ann' in line]
        assert ann.split()[1] == 'ann'
        assert "'hw1-' was removed from the name" in ann
        assert said.count('was removed from the name') == 1

        assert command.main(['collect', str(source), '--prefix', 'hw2-']) == command.USAGE
        assert "begin with 'hw2-' (--prefix), got: bob, hw1-ann" in capsys.readouterr().err

    def test_what_is_not_there_is_one_line(self, tmp_path, capsys):
        assert command.main(['collect', str(tmp_path / 'no.zip')]) == command.USAGE
        assert 'no.zip: cannot be read: no such file' in capsys.readouterr().err

        assert command.main(['collect', str(tmp_path), '--assignment', '03_tlk']) == command.USAGE
        assert f'Did you mean {TALK}?' in capsys.readouterr().err
