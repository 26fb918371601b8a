"""Sources of each kind, good and bad, to nbgrader's folders and one table."""

from __future__ import annotations

import json
import os
from pathlib import Path
import stat
import zipfile

import pytest

from autograder import __main__ as command
from autograder.collect import collect, LEFT, REPLACED, student_id, TAKEN, tree, UNCHANGED
from autograder.collect.kinds import kind_of
from autograder.collect.tree import NotCollectedError, opened
from autograder.layout import Layout
from autograder.whole_class.inbox import discover

TALK, LISTEN = '03_talk', '04_listen'


def notebook(*ids: str, text: str = 'x = 1') -> bytes:
    """Return a notebook with such cells."""
    cells = [
        {
            'cell_type': 'code',
            'metadata': {'nbgrader': {'grade_id': one, 'solution': True}},
            'source': text,
        }
        for one in ids
    ]
    return json.dumps({'cells': cells, 'metadata': {}, 'nbformat': 4}).encode()


GOOD, OTHER = notebook('talker'), notebook('listener')


@pytest.fixture
def layout(tmp_path) -> Layout:
    """Return a course of two assignments."""
    course = Layout(tmp_path / 'course')
    for name, file, cell in ((TALK, 'talk', 'talker'), (LISTEN, 'listen', 'listener')):
        folder = course.notebooks / name
        folder.mkdir(parents=True)
        (folder / f'{file}.ipynb').write_bytes(notebook(cell))
    return course


def packed(path: Path, files: dict[str, bytes]) -> Path:
    """Write a zip."""
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def laid(folder: Path, files: dict[str, bytes]) -> Path:
    """Write a folder."""
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder


def taken(layout: Layout) -> dict[str, bytes]:
    """Return all that lies in ``submitted/`` now."""
    return {
        path.relative_to(layout.submitted).as_posix(): path.read_bytes()
        for path in sorted(layout.submitted.rglob('*'))
        if path.is_file()
    }


def table(rows) -> dict[tuple[str, str], str]:
    """Return what was done, by student and place."""
    return {(row.student, row.place): row.done for row in rows}


CANVAS = {
    'exampleann_1001_55_talk.ipynb': notebook('talker', text='first'),
    'exampleann_1001_77_talk-1.ipynb': notebook('talker', text='second'),
    'berg_LATE_1002_56_talk.ipynb': GOOD,
    'chang_1003_57_listen.ipynb': OTHER,
    'diaz_1004_58_essay.pdf': b'%PDF',
    'evans_1005_59_My work (2).ipynb': GOOD,
}
MOODLE = {
    'Ann Example_311_assignsubmission_file_/talk.ipynb': GOOD,
    'Bo Berg_312_assignsubmission_file_/sub/talk (1).ipynb': GOOD,
    'Li Wei_313_assignsubmission_file_/talk.ipynb': GOOD,
    'Li Wei_314_assignsubmission_file_/talk.ipynb': GOOD,
    'Dee_315_assignsubmission_onlinetext/onlinetext.html': b'<p>hello',
}
GRADESCOPE = {
    'assignment_9_export/submission_metadata.yml': b"""
submission_1:
  :submitters:
  - :name: Ann Example
    :sid: '1001'
    :email: ann@example.org
  :created_at: 2026-03-01 12:00:00.000000000 Z
submission_2:
  :submitters:
  - :name: Bo
    :sid:
    :email: bo@example.org
  - :name: Cy
    :sid: '1003'
  :created_at: 2026-03-02 13:00:00 Z
submission_3:
  :submitters: nobody
""",
    'assignment_9_export/submission_1/talk.ipynb': GOOD,
    'assignment_9_export/submission_2/talk.ipynb': GOOD,
    'assignment_9_export/submission_3/talk.ipynb': GOOD,
}
EXCHANGE = {
    f'c/inbound/ann+{TALK}+2026-03-01 12:00:00 UTC+abc/talk.ipynb': notebook('talker', text='1'),
    f'c/inbound/ann+{TALK}+2026-03-02 12:00:00 UTC+def/talk.ipynb': notebook('talker', text='2'),
    f'c/inbound/ann+{TALK}+2026-03-02 12:00:00 UTC+def/timestamp.txt': b'2026',
    f'c/inbound/bob+{LISTEN}+2026-03-02 12:00:00 UTC/listen.ipynb': OTHER,
}
REPOSITORIES = {
    'talk-ann/.git/config': b'[core]',
    f'talk-ann/notebooks/{TALK}/talk.ipynb': GOOD,
    'talk-bob/.git/HEAD': b'ref',
    'talk-bob/talk.ipynb': GOOD,
    'talk-bob/scratch.ipynb': b'{}',
    'talk-cho/README.md': b'nothing yet',
}


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
    """As a zip, and as the folder that it was unpacked to."""

    def test_it_is_recognised(self, files, kind, how, tmp_path):
        """By names alone."""
        with opened(how(tmp_path / 'source.zip', files)) as found:
            assert kind_of(found) == kind

    def test_the_source_stays_as_it_is_and_a_second_time_changes_nothing(
        self, files, kind, how, tmp_path, layout
    ):
        """Collecting every evening is what people do."""
        source = how(tmp_path / 'source.zip', files)
        before = sorted((str(path), path.stat().st_mtime_ns) for path in source.rglob('*'))
        collect(source, layout, layout.submitted)
        first = taken(layout)

        again = collect(source, layout, layout.submitted)

        assert first
        assert taken(layout) == first
        assert {row.done for row in again} <= {UNCHANGED, LEFT}
        assert before == sorted((str(path), path.stat().st_mtime_ns) for path in source.rglob('*'))


def test_canvas_ids_are_user_ids_and_the_newest_counts(tmp_path, layout):
    """Late marks, files called otherwise and what is no notebook are in the table."""
    rows = collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)

    assert table(rows) == {
        ('1001', 'exampleann_1001_77_talk-1.ipynb'): TAKEN,
        ('1001', 'exampleann_1001_55_talk.ipynb'): LEFT,
        ('1002', 'berg_LATE_1002_56_talk.ipynb'): TAKEN,
        ('1003', 'chang_1003_57_listen.ipynb'): TAKEN,
        ('1004', 'diaz_1004_58_essay.pdf'): LEFT,
        ('1005', 'evans_1005_59_My work (2).ipynb'): TAKEN,
    }
    notes = {row.place: row.notes for row in rows}
    assert notes['berg_LATE_1002_56_talk.ipynb'] == ('late, as the source says',)
    assert notes['exampleann_1001_77_talk-1.ipynb'] == ('the newest of 2',)
    assert notes['exampleann_1001_55_talk.ipynb'] == ('an earlier one',)
    assert notes['diaz_1004_58_essay.pdf'] == ('no notebook, only essay.pdf',)
    assert notes['evans_1005_59_My work (2).ipynb'] == ("the file was called 'My work (2).ipynb'",)
    assert b'second' in taken(layout)[f'1001/{TALK}/talk.ipynb']


def test_the_wrong_assignment_is_left_with_its_name(tmp_path, layout):
    """Its cells say which it is, whatever the file is called."""
    files = {'ann/talk.ipynb': OTHER, 'bob/talk.ipynb': GOOD}

    rows = collect(laid(tmp_path / 's', files), layout, layout.submitted, assignment=TALK)

    assert [(row.student, row.done) for row in rows] == [('ann', LEFT), ('bob', TAKEN)]
    assert rows[0].notes == (f'wrong assignment: talk.ipynb is {LISTEN}',)


def test_moodle_names_become_ids_and_two_of_one_name_stay_two(tmp_path, layout):
    """The number alone is another one in the next assignment."""
    rows = collect(packed(tmp_path / 'm.zip', MOODLE), layout, layout.submitted)

    done = {row.student: row.done for row in rows}
    assert done == {
        'Ann Example': TAKEN,
        'Bo Berg': TAKEN,
        'Li Wei 313': TAKEN,
        'Li Wei 314': TAKEN,
        'Dee': LEFT,
    }


def test_gradescope_submissions_belong_to_everybody_named(tmp_path, layout):
    """With the time of delivery, for nbgrader's late policy."""
    collect(packed(tmp_path / 'g.zip', GRADESCOPE), layout, layout.submitted)

    found = taken(layout)
    assert set(found) == {
        f'{student}/{TALK}/{file}'
        for student in ('1001', 'bo@example.org', '1003')
        for file in ('talk.ipynb', 'timestamp.txt')
    } | {f'submission_3/{TALK}/talk.ipynb'}
    assert found[f'1001/{TALK}/timestamp.txt'] == b'2026-03-01 12:00:00 UTC\n'


def test_of_the_exchange_the_newest_counts(tmp_path, layout):
    """Of each assignment."""
    collect(laid(tmp_path / 'exchange', EXCHANGE), layout, layout.submitted)

    found = taken(layout)
    assert found[f'ann/{TALK}/talk.ipynb'] == notebook('talker', text='2')
    assert found[f'ann/{TALK}/timestamp.txt'] == b'2026-03-02 12:00:00 UTC\n'
    assert f'bob/{LISTEN}/listen.ipynb' in found


def test_repositories_lose_the_name_they_share(tmp_path, layout):
    """And nothing in them is run or followed, git's own files least of all."""
    rows = collect(laid(tmp_path / 'r', REPOSITORIES), layout, layout.submitted)

    assert {row.student: row.done for row in rows} == {'ann': TAKEN, 'bob': TAKEN, 'cho': LEFT}
    assert not [path for path in layout.submitted.rglob('*') if '.git' in path.parts]


def test_what_was_collected_can_be_graded(tmp_path, layout):
    """Names of all alphabets, and none that nbgrader misreads."""
    files = {
        'Zoë Ünal/talk.ipynb': GOOD,
        '李雷/talk.ipynb': GOOD,
        'a,b;c*/talk.ipynb': GOOD,
        '--/talk.ipynb': GOOD,
    }
    rows = collect(laid(tmp_path / 's', files), layout, layout.submitted)

    found = discover(layout.submitted, TALK, 'talk.ipynb', layout.assignments())
    assert [one.student for one in found] == ['Zoë Ünal', 'a_b_c', '李雷']
    assert all(one.recordable and not one.problems for one in found)
    assert ('no letter or digit in the name', "the name was '--'") in [row.notes for row in rows]


def test_two_names_that_become_one_are_both_left(tmp_path, layout):
    """Nobody gets somebody else's marks."""
    files = {'a,b/talk.ipynb': GOOD, 'a;b/talk.ipynb': GOOD}

    rows = collect(laid(tmp_path / 's', files), layout, layout.submitted)

    assert [row.done for row in rows] == [LEFT, LEFT]
    assert all("the same student id as 'a,b', 'a;b'" in row.notes[0] for row in rows)
    assert student_id('a,b') == student_id('a;b') == 'a_b'


class TestHostileSources:
    """Names and sizes that somebody made on purpose."""

    @pytest.mark.parametrize(
        ('name', 'why'),
        [
            ('../../evil/talk.ipynb', 'a path that leads elsewhere'),
            ('/etc/talk.ipynb', 'a path that leads elsewhere'),
            ('C:/x/talk.ipynb', 'an absolute path'),
            ('a\\..\\talk.ipynb', 'a name with characters that no system shows'),
            ('a/\x1b[31m/talk.ipynb', 'a name with characters that no system shows'),
        ],
    )
    def test_a_path_that_leads_elsewhere_is_left(self, name, why, tmp_path, layout):
        """The others are taken."""
        source = packed(tmp_path / 's.zip', {name: GOOD, 'ann/talk.ipynb': GOOD, 'b/x.txt': b''})

        rows = collect(source, layout, layout.submitted)

        assert (LEFT, (why,)) in [(row.done, row.notes) for row in rows]
        assert set(taken(layout)) == {f'ann/{TALK}/talk.ipynb'}

    def test_a_link_in_a_zip_is_left(self, tmp_path, layout):
        """Whatever it points to."""
        link = zipfile.ZipInfo('ann/talk.ipynb')
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        with zipfile.ZipFile(tmp_path / 's.zip', 'w') as archive:
            archive.writestr(link, '/etc/passwd')

        (row,) = collect(tmp_path / 's.zip', layout, layout.submitted)

        assert (row.done, row.notes) == (LEFT, ('a link or a special file',))

    def test_links_and_pipes_in_a_folder_are_left(self, tmp_path, layout):
        """Nobody waits for a pipe."""
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD})
        (source / 'bob').mkdir()
        (source / 'bob' / 'talk.ipynb').symlink_to(source / 'ann' / 'talk.ipynb')
        os.mkfifo(source / 'pipe')
        (source / 'loop').symlink_to(source)

        rows = collect(source, layout, layout.submitted)

        left = {row.place: row.notes[0] for row in rows if row.done == LEFT}
        assert left == dict.fromkeys(
            ('bob/talk.ipynb', 'loop', 'pipe'), 'a link or a special file'
        )
        assert set(taken(layout)) == {f'ann/{TALK}/talk.ipynb'}

    def test_a_file_that_grows_when_unpacked_is_bounded(self, tmp_path, layout, monkeypatch):
        """Its table of contents may say what it likes."""
        monkeypatch.setattr(tree, 'MAX_BYTES', 1000)
        source = packed(tmp_path / 's.zip', {'ann/talk.ipynb': b' ' * 100_000})

        (row,) = collect(source, layout, layout.submitted)

        assert row.done == LEFT
        assert 'more than' in row.notes[0]

    def test_far_too_many_files_are_refused_as_a_whole(self, tmp_path, layout, monkeypatch):
        """With what to try."""
        monkeypatch.setattr(tree, 'MOST_ENTRIES', 2)
        source = laid(tmp_path / 's', {f'{name}/talk.ipynb': GOOD for name in 'abc'})

        with pytest.raises(NotCollectedError, match='more than 2 files'):
            collect(source, layout, layout.submitted)

    def test_metadata_that_is_no_table_is_one_sentence(self, tmp_path, layout):
        """YAML makes no objects here."""
        text = b'!!python/object/apply:os.system ["touch /tmp/evil"]'
        source = laid(tmp_path / 's', {'submission_metadata.yml': text, 'a/b.ipynb': GOOD})

        with pytest.raises(NotCollectedError, match='expected YAML'):
            collect(source, layout, layout.submitted)

    def test_a_damaged_zip_is_one_sentence(self, tmp_path, layout):
        """A download that was cut off."""
        (tmp_path / 's.zip').write_bytes(packed(tmp_path / 'g.zip', MOODLE).read_bytes()[:200])

        with pytest.raises(NotCollectedError, match='expected a folder or a zip file'):
            collect(tmp_path / 's.zip', layout, layout.submitted)


def test_work_that_was_handed_in_again_replaces_the_old_one(tmp_path, layout):
    """Whole or not at all; nothing lies beside it."""
    collect(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}), layout, layout.submitted)
    newer = notebook('talker', text='newer')
    laid(tmp_path / 's', {'ann/talk.ipynb': newer})

    (row,) = collect(tmp_path / 's', layout, layout.submitted)

    assert row.done == REPLACED
    assert taken(layout) == {f'ann/{TALK}/talk.ipynb': newer}


def test_a_folder_that_is_a_link_is_not_written_through(tmp_path, layout):
    """Into somebody's own files."""
    layout.submitted.mkdir(parents=True)
    (tmp_path / 'elsewhere').mkdir()
    (layout.submitted / 'ann').symlink_to(tmp_path / 'elsewhere')

    (row,) = collect(laid(tmp_path / 's', {'ann/talk.ipynb': GOOD}), layout, layout.submitted)

    assert row.done == LEFT
    assert list((tmp_path / 'elsewhere').iterdir()) == []


class TestCommand:
    """As typed in a terminal."""

    @pytest.fixture(autouse=True)
    def here(self, layout, monkeypatch):
        """Let the course be the small one."""
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))

    def test_it_prints_a_table_and_tells_by_its_exit_code(self, tmp_path, layout, capsys):
        """1 if something was left."""
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD, 'bob/x.txt': b''})

        assert command.main(['collect', str(source)]) == command.FOR_REVIEW
        said = capsys.readouterr().out
        assert 'no notebook, only x.txt' in said
        assert '1 not taken, 1 taken.' in said

    def test_a_dry_run_writes_nothing(self, tmp_path, layout, capsys):
        """And says the same, as JSON if asked."""
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD})

        assert command.main(['collect', str(source), '--dry-run', '--json']) == command.OK
        (row,) = json.loads(capsys.readouterr().out)
        assert (row['student'], row['done']) == ('ann', TAKEN)
        assert not layout.submitted.exists()

    def test_what_is_not_there_is_one_line(self, tmp_path, capsys):
        """Exit code 2."""
        assert command.main(['collect', str(tmp_path / 'no.zip')]) == command.USAGE
        assert 'no.zip: expected a folder or a zip file' in capsys.readouterr().err

        assert command.main(['collect', str(tmp_path), '--assignment', '03_tlk']) == command.USAGE
        assert f'Did you mean {TALK}?' in capsys.readouterr().err
