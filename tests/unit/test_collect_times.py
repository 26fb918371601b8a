"""The times of submissions and their lateness, in the table and for a late policy."""

from contextlib import closing
from datetime import datetime, timedelta, timezone
import os
from pathlib import Path
import sqlite3
import sys

from collect_sources import (
    configure,
    GOOD,
    GRADESCOPE,
    laid,
    notebook,
    packed,
    taken,
    TALK,
)
import pytest

from autograder import __main__ as command
from autograder.collect.copy_notebooks import KEPT
from autograder.collect.course import due_dates
from autograder.collect.deliveries import LEFT, REPLACED, TAKEN, UNCHANGED
from autograder.collect.platforms import read_time
from autograder.collect.selection import late_notes
from autograder.commands import OK

UNKNOWN = f'it is unknown which notebook is newer; the other one is now in {KEPT}/'
NOON = datetime(2026, 3, 1, 12, tzinfo=timezone.utc)


def inbound(*times_: str, student: str = 'ann') -> dict[str, bytes]:
    """Return an exchange with submissions at these times."""
    return {
        f'{student}+{TALK}+{time}+q3rYx_-a/talk.ipynb': notebook('talker', text=time)
        for time in times_
    }


@pytest.fixture
def gradebook(layout) -> Path:
    """Return a gradebook with columns as in nbgrader 0.9, in which all work is due at noon."""
    layout.work.mkdir(parents=True)
    path = layout.work / 'gradebook.db'
    configure(layout.root, f'sqlite:///{path}')
    with closing(sqlite3.connect(path)) as book:
        book.executescript(f"""
            create table assignment (id varchar(32), name varchar(128), duedate datetime);
            create table submitted_assignment (
                id varchar(32), assignment_id varchar(32), student_id varchar(128),
                timestamp datetime, extension datetime);
            insert into assignment values ('a1', '{TALK}', '2026-03-01 12:00:00.000000');
            insert into assignment values ('a2', '04_listen', null);
            insert into submitted_assignment values ('s1', 'a1', 'eve', null, null);
            insert into submitted_assignment values
                ('s2', 'a1', 'dan', null, '1970-01-02 00:00:00.000000');
        """)
    return path


class TestReading:
    @pytest.mark.parametrize(
        ('text', 'hour'),
        [
            ('2026-03-01 12:00:00.123456 UTC', 12),
            ('2026-03-01 12:00:00 UTC', 12),
            ('2026-03-01 12:00:00 GMT', 12),
            ('2026-03-01T12:00:00Z', 12),
            ('2026-03-01 12:00:00.000000000 Z', 12),
            ('2026-03-01 12:00:00', 12),
            ('2026-03-01 12:00\n', 12),
            ('2026-03-01 12:00:00.5 +0100', 11),
            ('2026-03-01 12:00:00+01:00', 11),
            ('2026-03-01 12:00:00 -08', 20),
        ],
    )
    def test_offsets_are_understood(self, text, hour):
        assert read_time(text) == (NOON.replace(hour=hour), '')

    @pytest.mark.parametrize(
        ('text', 'note'),
        [
            ('2026-03-01 12:00:00.1 CET', 'time zone CET not understood, ignored'),
            (
                '2026-03-01 12:00:00 Europe/Berlin',
                'time zone Europe/Berlin not understood, ignored',
            ),
            ('2026-02-30 12:00:00 UTC', "time '2026-02-30 12:00:00 UTC' not understood, ignored"),
            (
                '0001-01-01 00:00:00 +1400',
                "time '0001-01-01 00:00:00 +1400' not understood, ignored",
            ),
            ('soon', "time 'soon' not understood, ignored"),
            ('', ''),
            (None, ''),
        ],
    )
    def test_what_is_not_understood_is_no_time(self, text, note):
        """Unknown and ambiguous times are ignored; CST, for example, names four time zones."""
        assert read_time(text) == (None, note)

    @pytest.mark.parametrize(
        ('late', 'words'),
        [
            (timedelta(hours=2, minutes=5, seconds=59), 'late by 2 h 5 min'),
            (timedelta(days=3, minutes=1), 'late by 3 d 1 min'),
            (timedelta(seconds=1), 'late by less than a minute'),
        ],
    )
    def test_lateness_is_reported_to_the_minute(self, late, words):
        assert late_notes('', NOON + late, NOON) == (words,)
        assert late_notes('Canvas', NOON + late, NOON) == (words,)
        assert late_notes('', NOON, NOON) == ()


def test_time_of_an_exchange_is_kept_and_shown(gather, layout):
    (row,) = gather(inbound('2026-03-01 12:34:56.789012 +0100'))

    assert (row.done, row.handed_in) == (TAKEN, '2026-03-01 11:34')
    assert taken(layout)[f'ann/{TALK}/timestamp.txt'] == b'2026-03-01 11:34:56 UTC\n'


class TestStampBesideANotebook:
    """The stamp ``STUDENT/ASSIGNMENT/timestamp.txt``, which nbgrader's collect writes."""

    @pytest.mark.parametrize('how', [packed, laid])
    def test_it_is_kept(self, how, gather, layout):
        files = {
            f'ann/{TALK}/talk.ipynb': GOOD,
            f'ann/{TALK}/timestamp.txt': b'2026-03-01 12:34:56.789012 UTC',
            'ann/04_listen/listen.ipynb': notebook('listener'),
            f'bob/{TALK}/talk.ipynb': GOOD,
            f'bob/{TALK}/timestamp.txt': b'2026-03-01 12:34:56 MEZ',
        }

        rows = gather(files, how)

        assert [row.handed_in for row in rows] == ['2026-03-01 12:34', '', '']
        assert rows[0].notes == (f'time from {TALK}/timestamp.txt',)
        assert rows[2].notes == ('time zone MEZ not understood, ignored',)
        assert taken(layout)[f'ann/{TALK}/timestamp.txt'] == b'2026-03-01 12:34:56 UTC\n'
        assert [name for name in taken(layout) if name.endswith('.txt')] == [
            f'ann/{TALK}/timestamp.txt'
        ]

    def test_one_of_a_student_counts_for_nothing_else(self, gather, layout):
        own = {'assignment_9_export/submission_101/timestamp.txt': b'2020-01-01 00:00'}

        gather({**GRADESCOPE, **own}, packed)

        assert b'2026-03-01' in taken(layout)[f'1001/{TALK}/timestamp.txt']

    @pytest.mark.parametrize(
        ('folder', 'git', 'note'),
        [
            # In a repository, the student can write the stamp.
            ('ann', 'ann/.git/HEAD', 'timestamp.txt ignored: in a repository'),
            ('ann', 'ann/.gitignore', 'timestamp.txt ignored: in a repository'),
            # nbgrader writes no stamp into this folder.
            ('ann/notebooks', '', ''),
        ],
    )
    def test_in_other_folders_it_does_not_count(self, folder, git, note, gather, layout):
        files = {f'{folder}/{TALK}/timestamp.txt': b'2020-01-01 00:00:00 UTC'}
        files |= {f'{folder}/{TALK}/talk.ipynb': GOOD, **({git: b''} if git else {})}

        (row,) = gather(files)

        assert row.handed_in == ''
        assert row.notes[0].startswith(note) if note else row.notes == ()
        assert set(taken(layout)) == {f'ann/{TALK}/talk.ipynb'}


class TestOlderWork:
    MONDAY, TUESDAY = '2026-03-02 12:00:00.5 UTC', '2026-03-03 12:00:00.5 UTC'

    def test_it_replaces_nothing_that_is_newer(self, gather, layout):
        gather(inbound(self.TUESDAY))
        before = taken(layout)

        for write in (False, True):
            (row,) = gather(inbound(self.MONDAY), write=write)
            assert row.done == LEFT
            assert row.notes[0] == 'older than the collected one from 2026-03-03 12:00'
        assert taken(layout) == before

    def test_newer_work_replaces_it(self, gather, layout):
        gather(inbound(self.MONDAY))

        (row,) = gather(inbound(self.TUESDAY))

        assert (row.done, row.notes) == (REPLACED, ())
        assert b'2026-03-03' in taken(layout)[f'ann/{TALK}/timestamp.txt']

    def test_the_same_work_keeps_the_time_of_the_last_hand_in(self, gather, layout):
        gather({f'ann+{TALK}+{self.TUESDAY}+x/talk.ipynb': GOOD})
        before = taken(layout)

        (row,) = gather({f'ann+{TALK}+{self.MONDAY}+x/talk.ipynb': GOOD})

        assert (row.done, row.notes) == (UNCHANGED, ('handed in again later',))
        assert taken(layout) == before

    @pytest.mark.parametrize('there', [None, b'soon', b'\xff'])
    def test_without_a_time_nobody_knows(self, there, gather, layout):
        laid(layout.submitted, {f'ann/{TALK}/talk.ipynb': notebook('talker', text='there')})
        if there is not None:
            laid(layout.submitted, {f'ann/{TALK}/timestamp.txt': there})

        (row,) = gather(inbound(self.MONDAY))

        assert (row.done, row.notes) == (REPLACED, (UNKNOWN,))
        assert b'2026-03-02' in taken(layout)[f'ann/{TALK}/timestamp.txt']


class TestStaleTime:
    """A saved time belongs only to the notebook next to it."""

    def test_newer_work_without_a_time_loses_the_old_one(self, gather, layout):
        """The old time is removed; otherwise late work would seem to be on time."""
        gather(inbound('2026-03-01 12:00:00 UTC'))

        for write in (False, True):
            assert f'ann/{TALK}/timestamp.txt' in taken(layout)
            (row,) = gather({'ann/talk.ipynb': GOOD}, write=write)
            removed = 'the time of the replaced notebook, 2026-03-01 12:00, was removed'
            assert (row.done, row.notes) == (REPLACED, (f'{UNKNOWN}; {removed}',))
        old = notebook('talker', text='2026-03-01 12:00:00 UTC')
        assert taken(layout) == {
            f'ann/{TALK}/{KEPT}/talk-replaced.ipynb': old,
            f'ann/{TALK}/talk.ipynb': GOOD,
        }
        assert [row.done for row in gather({'ann/talk.ipynb': GOOD})] == [UNCHANGED]

    def test_the_same_work_keeps_its_time(self, gather, layout):
        """Work that has not changed keeps its time, which a person may have written."""
        gather({'ann/talk.ipynb': GOOD})
        laid(layout.submitted, {f'ann/{TALK}/timestamp.txt': b'2026-03-01 12:00:00 UTC\n'})

        (row,) = gather({'ann/talk.ipynb': GOOD})

        assert row.done == UNCHANGED
        assert f'ann/{TALK}/timestamp.txt' in taken(layout)


class TestDueDates:
    def test_late_work_is_reported(self, gather, gradebook):
        late = '2026-03-01 14:05:30.000000 UTC'
        files = {
            **inbound('2026-03-01 11:59:59.999999 UTC', student='bob'),
            **inbound(late, student='ann'),
            **inbound(late, student='dan'),
            **inbound(late, student='eve'),
        }

        assert {row.student: row.notes for row in gather(files)} == {
            'ann': ('late by 2 h 5 min',),
            'bob': (),
            'dan': (),
            'eve': ('late by 2 h 5 min',),
        }

    def test_looking_makes_no_gradebook_and_changes_none(self, gather, gradebook):
        before = gradebook.read_bytes()
        gather(inbound('2026-03-01 14:00:00 UTC'))
        assert gradebook.read_bytes() == before
        gradebook.unlink()

        (row,) = gather(inbound('2026-03-01 14:00:00 UTC'))

        assert row.notes == ()
        assert not gradebook.exists()

    def test_a_damaged_gradebook_is_one_line(self, gather, gradebook):
        gradebook.write_bytes(b'SQLite format 3\x00' + b'\xff' * 4096)
        rows = gather(inbound('2026-03-01 14:00:00 UTC'))

        assert [row.done for row in rows] == ['not taken', TAKEN]
        unknown = 'due dates unknown, because the gradebook cannot be read'
        assert rows[0].notes[0].startswith(unknown)

    def test_nbgrader_is_not_imported(self, tmp_path, layout, gradebook):
        """Collecting does not import nbgrader, which takes seconds."""
        before = set(sys.modules)
        due_dates(layout)

        assert not [name for name in set(sys.modules) - before if name.startswith('nbgrader')]

    @pytest.mark.slow
    @pytest.mark.nbgrader
    def test_a_gradebook_of_nbgrader_is_read(self, layout, gradebook, monkeypatch):
        from nbgrader.api import Gradebook

        gradebook.unlink()
        beside = str(Path(sys.prefix) / 'bin')  # the folder of alembic
        monkeypatch.setenv('PATH', os.pathsep.join([beside, os.environ['PATH']]))
        with Gradebook(f'sqlite:///{gradebook}', 'course') as book:
            book.add_assignment(TALK, duedate='2026-03-01 13:00:00 +0100')
            book.add_student('dan')
            book.add_submission(TALK, 'dan')
            book.grant_extension(TALK, 'dan', hours=3)

        found = due_dates(layout)

        assert found.of('dan', TALK) - found.of('ann', TALK) == timedelta(hours=3)
        assert found.of('ann', '04_listen') is None


def test_the_table_has_the_time(tmp_path, here, gradebook, capsys):
    source = laid(tmp_path / 'inbound', inbound('2026-03-01 14:05:30.000000 UTC'))

    assert command.main(['collect', str(source), '--trust-names']) == OK
    said = capsys.readouterr().out
    assert 'Handed in' in said
    assert '2026-03-01 14:05' in said
    assert 'late by 2 h 5 min' in said
