"""Collect valid and invalid sources of each kind for nbgrader, and report them in a table."""

import os
import stat
import zipfile

from collect_sources import (
    collect,
    configure,
    every_kind,
    GOOD,
    laid,
    limit,
    LISTEN,
    MOODLE,
    notebook,
    packed,
    taken,
    TALK,
)
import pytest

from autograder import __main__ as command
from autograder.classroom.collected import read_not_collected
from autograder.classroom.course_lock import lock_course
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import last_results, results_file
from autograder.collect.deliveries import LEFT, REPLACED, TAKEN, UNCHANGED
from autograder.commands import FOR_REVIEW, OK
from autograder.results import SubmissionResult
from autograder.submission.inbox import discover, is_student_id, student_id
from autograder.submission.reading import UnusableUploadError


@every_kind
@pytest.mark.parametrize('how', [packed, laid])
def test_the_source_stays_as_it_is_and_a_second_time_changes_nothing(
    files, expected, how, tmp_path, layout
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


def test_what_was_collected_can_be_graded(gather, layout):
    """Nbgrader can read all ids, including those made from names in other alphabets."""
    files = {
        'Zoë Ünal/talk.ipynb': GOOD,
        '李雷/talk.ipynb': GOOD,
        'अमित/talk.ipynb': GOOD,
        'अमीत/talk.ipynb': GOOD,
        'a,b;c*/talk.ipynb': GOOD,
        '--/talk.ipynb': GOOD,
    }
    rows = gather(files)

    found = discover(layout.submitted, TALK, 'talk.ipynb', layout.assignments())
    assert [one.student for one in found] == [
        'Zoë Ünal', 'a_b_c--3923e48481b1', 'अमित', 'अमीत', '李雷'
    ]  # fmt: skip
    assert all(one.recordable and not one.problems for one in found)
    assert ('no letter or digit in the name', "the name was '--'") in [row.notes for row in rows]


def test_two_names_that_become_one_are_both_left(gather):
    """If two names give one id, neither is collected: no student gets another's marks."""
    rows = gather({'ann/talk.ipynb': GOOD, 'hw-ann/talk.ipynb': GOOD}, prefix='hw-')

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
            ('a\\..\\talk.ipynb', 'a name with a backslash'),
            ('a/\x1b[31m/talk.ipynb', 'a name with unprintable characters'),
            ('a/' + 'x/' * 30_000 + 'talk.ipynb', 'a path that is far too long'),
        ],
        ids=['upwards', 'root', 'drive', 'backslash', 'escape', 'slashes'],
    )
    def test_a_path_that_cannot_be_used_is_left(self, name, why, gather, layout):
        rows = gather({name: GOOD, 'ann/talk.ipynb': GOOD, 'b/x.txt': b''}, packed)

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

    def test_a_file_that_grows_when_unpacked_is_bounded(self, gather, monkeypatch):
        """The number of unpacked bytes is limited, whatever size the zip states."""
        limit(monkeypatch, file_bytes=1000)

        (row,) = gather({'ann/talk.ipynb': b' ' * 100_000}, packed)

        assert row.done == LEFT
        assert 'more than' in row.notes[0]

    def test_far_too_many_files_are_refused_as_a_whole(self, gather, monkeypatch):
        limit(monkeypatch, entries=2)

        with pytest.raises(UnusableUploadError, match='more than 2 files'):
            gather({f'{name}/talk.ipynb': GOOD for name in 'abc'})

    @pytest.mark.parametrize('how', [packed, laid])
    def test_generated_files_do_not_count_towards_the_size_limit(self, how, gather, monkeypatch):
        work = ('src/ros_ws/build/x', 'install/COLCON_IGNORE', 'install/x.ipynb', '.venv/a/x.py')
        files = {f'{name}/{file}': GOOD for name in ('ann', 'bob') for file in work}
        files |= {'ann/talk.ipynb': GOOD, 'ann/build/notes.txt': b'', 'cy/log/talk.ipynb': GOOD}
        limit(monkeypatch, entries=12)

        rows = gather(files, how)

        assert [(row.student, row.done) for row in rows] == [
            ('ann', TAKEN), ('bob', LEFT), ('cy', TAKEN)
        ]  # fmt: skip
        assert rows[1].notes == ('no file that can be read',)
        limit(monkeypatch, listed=5)
        with pytest.raises(UnusableUploadError, match='more than 5 files'):
            gather(files, how)

    @pytest.mark.parametrize('name', ['build', 'install', 'log'])
    def test_a_students_own_folder_is_no_programs(self, name, gather):
        files = {f'{name}/COLCON_IGNORE': b'', f'{name}/talk.ipynb': GOOD, 'ann/talk.ipynb': GOOD}

        assert {row.student: row.done for row in gather(files)} == {'ann': TAKEN, name: TAKEN}

    @pytest.mark.parametrize(
        'text',
        [
            b'!!python/object/apply:os.system ["touch /tmp/evil"]',
            b'submission_1:\n  :created_at: 2026-13-45 10:00:00\n',
        ],
    )
    def test_metadata_that_is_no_table_is_one_sentence(self, text, gather):
        """YAML in a source creates no objects."""
        with pytest.raises(UnusableUploadError, match='not valid YAML'):
            gather({'submission_metadata.yml': text, 'a/b.ipynb': GOOD})

    def test_a_damaged_zip_is_one_sentence(self, tmp_path, layout):
        (tmp_path / 's.zip').write_bytes(packed(tmp_path / 'g.zip', MOODLE).read_bytes()[:200])

        with pytest.raises(UnusableUploadError, match='the zip file cannot be read'):
            collect(tmp_path / 's.zip', layout, layout.submitted)


def test_work_that_was_handed_in_again_replaces_the_old_one(tmp_path, gather, layout):
    """The old work is kept where nbgrader and the grader do not look, and leaves with the rest."""
    gather({'ann/talk.ipynb': GOOD})
    newer = notebook('talker', text='newer')

    (row,) = gather({'ann/talk.ipynb': newer})

    assert row.done == REPLACED
    kept = f'ann/{TALK}/.ipynb_checkpoints/talk-replaced.ipynb'
    assert taken(layout) == {kept: GOOD, f'ann/{TALK}/talk.ipynb': newer}
    (found,) = discover(layout.submitted, TALK, 'talk.ipynb')
    assert found.path == layout.submitted / 'ann' / TALK / 'talk.ipynb'
    (row,) = collect(layout.submitted, layout, tmp_path / 'again')
    assert row.notes == ()


def test_a_folder_that_is_a_link_is_not_written_through(tmp_path, gather, layout):
    layout.submitted.mkdir(parents=True)
    (tmp_path / 'elsewhere').mkdir()
    (layout.submitted / 'ann').symlink_to(tmp_path / 'elsewhere')

    (row,) = gather({'ann/talk.ipynb': GOOD})

    assert row.done == LEFT
    assert list((tmp_path / 'elsewhere').iterdir()) == []


@pytest.mark.usefixtures('here')
class TestCommand:
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
        assert said.startswith('1 taken. Nothing was written (--dry-run).')
        assert said.endswith('Rows without news: 1 (--all shows them).\n')
        assert not layout.submitted.exists()

    def test_the_table_has_only_news(self, tmp_path, capsys):
        files = {'ann/talk.ipynb': GOOD, 'bob/work.ipynb': GOOD, 'cy/x.txt': b''}
        source = str(laid(tmp_path / 's', files))

        rows = []
        for options in ((), (), ('--all',)):
            command.main(['collect', source, *options])
            lines = capsys.readouterr().out.splitlines()
            rows.append([line.split()[1] for line in lines if line.startswith('│')])
        assert rows == [['bob', 'cy'], ['cy'], ['ann', 'bob', 'cy']]

    def test_the_example_students_leave_when_a_class_comes(self, tmp_path, layout, capsys):
        laid(layout.sample_class, {f'{TALK}/pass__example/expected.json': b'{}'})
        example = laid(layout.submitted, {f'pass__example/{TALK}/talk.ipynb': GOOD})
        everybody = [SubmissionResult(one, TALK) for one in ('ann', 'pass__example')]
        write_all_reports(layout, TALK, everybody)
        write_all_reports(layout, LISTEN, everybody[1:])
        empty = laid(tmp_path / 'empty', {'ann/x.txt': b''})
        configure(layout.root, f'sqlite:///{tmp_path}/none.db')

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

    @pytest.mark.parametrize('name', ['grades.csv', 'talk.ipynb'])
    def test_another_file_is_not_called_a_zip(self, name, tmp_path, capsys):
        source = laid(tmp_path / 's', {name: GOOD}) / name

        assert command.main(['collect', str(source)]) == command.USAGE
        said = capsys.readouterr().err
        assert f'{name}: expected a folder or a zip file, got a different file. Try: ' in said

    def test_what_is_not_there_is_one_line(self, tmp_path, capsys):
        assert command.main(['collect', str(tmp_path / 'no.zip')]) == command.USAGE
        assert 'no.zip: cannot be read: no such file' in capsys.readouterr().err

        assert command.main(['collect', str(tmp_path), '--assignment', '03_tlk']) == command.USAGE
        assert f'Did you mean {TALK}?' in capsys.readouterr().err
