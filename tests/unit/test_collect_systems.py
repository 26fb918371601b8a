"""Each platform's file names, even rare ones: owners are found, and no file is lost."""

from collect_sources import (
    AT_ONE,
    CANVAS,
    collect,
    EXCHANGE,
    GOOD,
    GRADESCOPE,
    kind,
    laid,
    LISTEN,
    METADATA,
    notebook,
    notes,
    packed,
    table,
    taken,
    TALK,
)
import pytest

from autograder.classroom.collected import read_collected, read_not_collected
from autograder.collect.deliveries import LEFT, REPLACED, TAKEN, UNCHANGED
from autograder.collect.selection import ASK
from autograder.submission.reading import UnusableUploadError

LATE = (
    'late, according to Canvas; the time is unknown, so a late policy cannot apply. '
    'Try: write the time into timestamp.txt (docs/gradebook.md)'
)


class TestCanvas:
    """Canvas names files ``NAME_[LATE_]USER_ATTACHMENT_FILE``."""

    def test_ids_are_user_ids_and_the_newest_counts(self, gather, layout):
        rows = gather(CANVAS, packed)

        assert table(rows) == {
            ('1001', 'exampleann_1001_55077_talk-1.ipynb'): TAKEN,
            ('1001', 'exampleann_1001_55001_talk.ipynb'): LEFT,
            ('1002', 'berg_LATE_1002_55002_talk.ipynb'): TAKEN,
            ('1003', 'chang_1003_55003_listen.ipynb'): LEFT,
            ('1004', 'diaz_1004_55004_essay.pdf'): LEFT,
            ('1005', 'evans_1005_55005_My work (2).ipynb'): TAKEN,
            ('1006', 'fox_1006_text.html'): LEFT,
        }
        said = notes(rows)
        assert said['berg_LATE_1002_55002_talk.ipynb'] == (LATE,)
        assert said['chang_1003_55003_listen.ipynb'] == (
            f'wrong assignment: listen.ipynb belongs to {LISTEN}',
        )
        assert said['exampleann_1001_55077_talk-1.ipynb'] == ('the newest of 2 attempts',)
        assert said['exampleann_1001_55001_talk.ipynb'] == ('a newer notebook was collected',)
        assert said['diaz_1004_55004_essay.pdf'] == ('no notebook, only essay.pdf', ASK)
        assert said['evans_1005_55005_My work (2).ipynb'] == (
            "the file was called 'My work (2).ipynb'",
        )
        assert b'second' in taken(layout)[f'1001/{TALK}/talk.ipynb']

    def test_an_old_download_replaces_nothing_that_is_newer(self, gather, layout):
        """Canvas gives each file that is handed in again a larger number."""
        old, new, newest = (
            {f'ann_1001_{n}_talk.ipynb': notebook('talker', text=f'{n}')} for n in (99, 100, 101)
        )
        done = []
        for files in (new, old, new, newest, new):
            (row,) = gather(files, packed)
            done.append(row.done)

        assert done == [TAKEN, LEFT, UNCHANGED, REPLACED, LEFT]
        assert row.notes[0] == (
            'number 100 in Canvas, older than the collected one, which has 101. '
            'Try: to collect it anyway, delete the collected one'
        )
        assert b'101' in taken(layout)[f'1001/{TALK}/talk.ipynb']
        assert not read_not_collected(layout)
        gather({'1001/talk.ipynb': GOOD, '1002/talk.ipynb': GOOD})
        (row,) = gather(old, packed)
        assert row.notes == (
            'it is unknown which notebook is newer; the other one is now in .ipynb_checkpoints/',
        )

    def test_another_folder_has_no_part_in_the_order(self, tmp_path, layout):
        """The saved numbers are those of the notebooks in ``submitted/``."""
        for number, to in ((100, layout.submitted), (101, tmp_path), (100, layout.submitted)):
            files = {f'ann_1001_{number}_talk.ipynb': notebook('talker', text=f'{number}')}
            (row,) = collect(packed(tmp_path / f'{number}.zip', files), layout, to)

        assert (row.done, row.notes) == (UNCHANGED, ())
        assert [one.turn for one in read_collected(layout)] == ['100']
        (row,) = collect(tmp_path / '100.zip', layout, tmp_path)
        assert row.done == REPLACED

    def test_attachments_are_compared_as_numbers(self, gather, layout):
        """Attachment 99 is older than 100, and the newest counts even if a cell was deleted."""
        files = {
            'ann_1001_99_talk.ipynb': notebook('talker', 'talk_rate', text='old'),
            'ann_1001_100_talk-1.ipynb': notebook('talker', text='new'),
        }

        gather(files, packed)

        assert b'new' in taken(layout)[f'1001/{TALK}/talk.ipynb']

    @pytest.mark.parametrize(
        ('name', 'what'),
        [
            ('exampleann_1001_text.html', 'the student submitted text instead of a file'),
            ('exampleann_1001_link.html', 'the student submitted a link instead of a file'),
            ('exampleann_LATE_1001_text.html', 'the student submitted text instead of a file'),
        ],
    )
    def test_what_was_typed_in_is_reported(self, name, what, gather):
        rows = gather({name: b'<html>', 'berg_1002_56_talk.ipynb': GOOD}, packed)

        (row,) = [row for row in rows if row.done == LEFT]
        assert (row.student, row.place, row.notes[0]) == ('1001', name, what)
        assert (row.notes[1:] == ('late, according to Canvas',)) is ('LATE' in name)

    @pytest.mark.parametrize(
        'name',
        [
            'anon_aB3dE_55_talk.ipynb',
            'LATE_anon_aB3dE_55_talk.ipynb',
            'anon_aB3dE_LATE_55_talk.ipynb',
        ],
    )
    def test_anonymous_grading_has_ids_of_its_own(self, name, tmp_path, layout):
        """With anonymous grading, Canvas writes an id instead of name and number."""
        files = {name: GOOD, 'anon_Zz9kQ_56_link.html': b'<html>'}
        source = packed(tmp_path / 'c.zip', files)

        rows = collect(source, layout, layout.submitted)

        assert kind(source) == 'canvas'
        assert {row.student: row.done for row in rows} == {'anon_aB3dE': TAKEN, 'anon_Zz9kQ': LEFT}
        assert (LATE in notes(rows)[name]) is ('LATE' in name)

    @pytest.mark.parametrize(
        'name',
        [
            'jane_doe_1003_55003_talk.ipynb',
            'jane_doe_LATE_1003_55003_talk.ipynb',
            '_1003_55003_talk.ipynb',
            'jane_1003_55003_07_talk.ipynb',
            'jane_1003_55003_7_talk.ipynb',
            f'jane_1003_55003_{"9" * 320}_talk.ipynb',
            'jane_1003_55003_LATE_1001_55001_talk.ipynb',
            'jane_1003_55003_1001_55001_talk.ipynb',
            'jane_102_1003_55003_talk.ipynb',
            'jane_1001_1003_55003_talk.ipynb',
        ],
    )
    def test_numbers_in_names_are_distinguished_from_ids(self, name, gather, layout):
        """A user's id is close to the ids of other users, and belongs to only one name."""
        files = {
            name: GOOD,
            'exampleann_1001_55001_talk.ipynb': notebook('talker', text='of ann'),
            'berg_1002_55002_talk.ipynb': notebook('talker', text='of berg'),
        }

        rows = gather(files, packed)

        assert table(rows)['1003', name] == TAKEN
        assert b'of ann' in taken(layout)[f'1001/{TALK}/talk.ipynb']
        assert len(rows) == 3

    def test_two_attachments_of_one_user_tell_where_the_name_ends(self, gather, layout):
        """A number in two files is the user's, because each attachment has a different number."""
        files = {
            'a_102_1001_55_talk.ipynb': notebook('talker', text='old'),
            'a_102_1001_77_talk-1.ipynb': notebook('talker', text='new'),
        }

        rows = gather(files, packed)

        assert {row.student for row in rows} == {'1001'}
        assert (
            'user 1001, according to the other files' in notes(rows)['a_102_1001_77_talk-1.ipynb']
        )
        assert b'new' in taken(layout)[f'1001/{TALK}/talk.ipynb']

    def test_ambiguous_files_have_no_owner(self, gather):
        (row,) = gather({'a_102_1001_55_talk.ipynb': GOOD}, packed)

        assert (row.student, row.done) == ('', LEFT)
        assert row.notes == ('the owner is unclear: user 1001 or user 102; rename the file',)

    def test_a_class_whose_files_all_begin_with_a_number_is_read(self, gather):
        rows = gather({f'a_{n}_55{n}_7_talk.ipynb': GOOD for n in (101, 102)}, packed)

        assert {row.student: row.done for row in rows} == {'101': TAKEN, '102': TAKEN}

    def test_what_has_no_name_of_canvas_is_in_the_table(self, gather):
        more = {'roster.csv': b'', 'extra/one.txt': b'', 'extra/two.txt': b''}
        rows = gather({**CANVAS, **more}, packed)

        why = ('not named the way canvas names submissions',)
        said = notes(rows)
        assert (said['roster.csv'], said['extra']) == (why, why)
        assert len(rows) == len(CANVAS) + 2


class TestGradescope:
    """Gradescope writes ``submission_metadata.yml`` and one folder per submission."""

    def test_submissions_belong_to_everybody_named(self, gather, layout):
        gather(GRADESCOPE, packed)

        found = taken(layout)
        assert set(found) == {
            f'{student}/{TALK}/{file}'
            for student in ('1001', 'bo@example.org', '1003')
            for file in ('talk.ipynb', 'timestamp.txt')
        } | {f'submission_103/{TALK}/talk.ipynb'}
        assert found[f'1001/{TALK}/timestamp.txt'] == b'2026-03-01 12:00:00 UTC\n'
        assert found[f'1003/{TALK}/timestamp.txt'] == b'2026-03-02 13:00:00 UTC\n'

    def test_what_is_only_in_the_table_or_only_a_folder_is_reported(self, gather):
        files = {
            'submission_metadata.yml': METADATA,
            'submission_101/talk.ipynb': GOOD,
            'submission_999/talk.ipynb': GOOD,
            'submission_103': b'a file in place of a folder',
            'notes/talk.ipynb': GOOD,
        }

        rows = gather(files, packed)

        assert table(rows) == {
            ('1001', 'submission_101'): TAKEN,
            ('1003', 'submission_102'): LEFT,
            ('bo@example.org', 'submission_102'): LEFT,
            ('submission_103', 'submission_103'): LEFT,
            ('', 'submission_999'): LEFT,
            ('', 'notes'): LEFT,
        }
        said = notes(rows)
        assert said['submission_102'] == ('no file that can be read',)
        for name in ('submission_999', 'notes'):
            assert said[name] == ('not in submission_metadata.yml, so its owner is unknown',)
        assert len(rows) == 6

    @pytest.mark.parametrize(
        'created', [b'0001-01-01 00:00:00 +14:00', b'[a, b]', b'noon', b'2026-03-01']
    )
    def test_a_time_that_is_none_stops_nobody(self, created, gather):
        table_ = b"submission_1:\n  :submitters:\n  - :sid: '7'\n  :created_at: " + created
        files = {'submission_metadata.yml': table_, 'submission_1/talk.ipynb': GOOD}
        (row,) = gather(files, packed)

        assert (row.done, row.handed_in) == (TAKEN, '')


class TestExchange:
    """An exchange of nbgrader has folders ``inbound/USER+ASSIGNMENT+TIME+RANDOM``."""

    def test_the_newest_counts(self, gather, layout):
        rows = gather(EXCHANGE)

        found = taken(layout)
        assert found[f'ann/{TALK}/talk.ipynb'] == notebook('talker', text='2')
        assert found[f'ann/{TALK}/timestamp.txt'] == b'2026-03-02 12:00:00 UTC\n'
        assert f'bob/{LISTEN}/listen.ipynb' in found
        assert sorted(row.student for row in rows) == ['ann', 'ann', 'bob']

    def test_each_folder_of_an_exchange_can_be_named(self, tmp_path, layout):
        source = laid(tmp_path / 'exchange', EXCHANGE)
        (source / 'c' / 'inbound' / f'cy+{TALK}+{AT_ONE}').mkdir()

        first, *others = (
            collect(folder, layout, layout.submitted)
            for folder in (source, source / 'c', source / 'c' / 'inbound')
        )

        assert notes(first)[f'cy+{TALK}+{AT_ONE}'] == ('no file that can be read',)
        assert [table(rows).keys() for rows in others] == [table(first).keys()] * 2

    def test_an_exchange_of_several_courses_is_not_mixed(self, gather):
        files = {**EXCHANGE, **{name.replace('c/', 'd/', 1): GOOD for name in EXCHANGE}}

        with pytest.raises(UnusableUploadError, match='this exchange has 2 courses'):
            gather(files)

    def test_releases_are_nobodys_work_before_the_first_hand_in(self, tmp_path, layout):
        source = laid(tmp_path / 'exchange', {f'c/outbound/{TALK}/talk.ipynb': GOOD})
        (source / 'c' / 'inbound').mkdir()

        assert collect(source, layout, layout.submitted) == []

    def test_work_for_another_assignment_is_ignored_if_one_is_wanted(self, gather, layout):
        """Only the assignment in the folder's name counts, whatever its notebook contains."""
        files = {f'inbound/ann+{LISTEN}+2026-03-01 12:00:00 UTC+x/listen.ipynb': b'{}'}

        assert not gather(files, assignment=TALK)
        assert not read_not_collected(layout)
