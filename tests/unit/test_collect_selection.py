"""The choice of the notebook for an assignment, and limits on reading."""

import io
import json
import tracemalloc

from collect_sources import (
    collect,
    DAMAGED,
    done,
    GOOD,
    laid,
    limit,
    LISTEN,
    notebook,
    notes,
    OTHER,
    OWN,
    packed,
    SPIN,
    taken,
    TALK,
)
import pytest

from autograder.collect import deliveries, selection
from autograder.collect.deliveries import LEFT, Row, TAKEN
from autograder.submission.reading import UnusableUploadError

RIGHT, COPY = notebook('talker', text='right'), notebook('talker', text='copy')
CHOSEN = (
    '{} was chosen, not {}: {} cells of the assignment. Try: if that is wrong, unpack the '
    'download, delete {} and collect the folder'
)
PLAIN = CHOSEN.format(
    'talk.ipynb',
    'talk (1).ipynb, talk-Copy1.ipynb, a.ipynb',
    'they have equally many',
    'talk.ipynb',
)
STRANGE = 'it contains no cell of the assignment'
CUT = (
    'not a notebook, but JSON that ends in the middle, after 40 bytes. Try: ask the student to '
    'open the notebook in JupyterLab, save it and submit the saved file'
)
EMPTY = (
    'not a notebook, but an empty file. Try: ask the student to save the notebook and submit again'
)


COPIES = {
    'talk-Copy1.ipynb': COPY,
    'talk.ipynb': RIGHT,
    'talk (1).ipynb': COPY,
    'a.ipynb': COPY,
}
"""Browsers and Jupyter give such names to copies."""


class TestSeveralAssignments:
    """A student's folder or repository may contain all assignments."""

    @pytest.mark.parametrize('place', ['{}/notebooks/{}/{}.ipynb', '{}/{}/{}.ipynb'])
    def test_one_notebook_of_each_is_taken(self, place, gather):
        """A lesson without graded cells is recognised by its file name."""
        files = {
            place.format(name, lesson, lesson[3:]): data
            for name in ('ann', 'bob')
            for lesson, data in ((TALK, GOOD), (LISTEN, OTHER), (SPIN, OWN))
        }

        rows = gather(files)

        assert done(rows) == [
            (name, lesson, TAKEN) for name in ('ann', 'bob') for lesson in (TALK, LISTEN, SPIN)
        ]
        assert all(row.notes == () for row in rows)

    def test_the_one_wanted_is_taken_alone(self, gather):
        files = {f'ann/{TALK}/talk.ipynb': GOOD, f'ann/{LISTEN}/listen.ipynb': OTHER}

        assert done(gather(files, assignment=LISTEN)) == [('ann', LISTEN, TAKEN)]

    def test_content_says_which_assignment_it_is(self, gather, layout):
        rows = gather({f'ann/{TALK}/talk.ipynb': OTHER, f'ann/{LISTEN}/listen.ipynb': GOOD})

        assert done(rows) == [('ann', TALK, TAKEN), ('ann', LISTEN, TAKEN)]
        assert taken(layout)[f'ann/{TALK}/talk.ipynb'] == GOOD


class TestOneAssignmentASource:
    """A Canvas, Moodle or Gradescope export belongs to one assignment, whatever it contains."""

    CANVAS = 'ann_1001_56001_{0}', 'bob_1002_56002_{0}', 'cy_1003_56003_{1}', 'cy_1003_56004_{0}'
    MOODLE = tuple(
        f'{name}_assignsubmission_file/{{{at}}}'
        for name, at in (('ann_311', 0), ('bob_312', 0), ('cy_313', 1), ('cy_313', 0))
    )

    @pytest.mark.parametrize('places', [CANVAS, MOODLE], ids=['canvas', 'moodle'])
    def test_a_notebook_of_another_lesson_replaces_nothing(self, places, gather, layout):
        before = {f'{name}/{LISTEN}/listen.ipynb': b'right' for name in ('1003', 'cy')}
        laid(layout.submitted, before)
        names = 'talk.ipynb', 'listen.ipynb'
        files = {place.format(*names): OTHER if '{1}' in place else GOOD for place in places}

        rows = gather(files, packed)

        assert taken(layout).items() >= before.items()
        assert [row.done for row in rows].count(TAKEN) == 3
        assert {row.assignment for row in rows} == {TALK}
        (left,) = [row for row in rows if row.done == LEFT]
        assert left.notes[0] == f'wrong assignment: listen.ipynb belongs to {LISTEN}'

    @pytest.mark.parametrize(
        ('one', 'two', 'said'),
        [
            (GOOD, OTHER, f'as many from {LISTEN} as from {TALK}. Try: --assignment'),
            (OWN, OWN, 'none is from this course'),
        ],
    )
    def test_what_is_not_sure_is_refused(self, one, two, said, gather, layout):
        files = {'ann_1001_561_a.ipynb': one, 'bob_1002_562_b.ipynb': two}

        with pytest.raises(UnusableUploadError, match=said) as caught:
            gather(files, packed)
        assert TALK in caught.value.fix
        assert not layout.submitted.exists()

        rows = gather(files, packed, assignment=TALK)
        assert (rows[0].assignment, rows[0].done) == (TALK, TAKEN)

    def test_a_student_counts_once(self, gather, layout):
        files = {f'eve_1_5{n}_listen-{n}.ipynb': OTHER for n in range(10, 30)}
        files |= {'ann_2_571_talk.ipynb': GOOD, 'bob_3_572_talk.ipynb': GOOD}

        gather(files, packed)

        assert set(taken(layout)) == {f'{name}/{TALK}/talk.ipynb' for name in '23'}

    def test_without_a_notebook_the_table_says_what_there_is(self, gather):
        (row,) = gather({'a_1_2_x.pdf': b''}, packed)

        assert (row.done, row.notes) == (LEFT, ('no notebook, only x.pdf', selection.ASK))


class TestTheRightOne:
    """Cells are compared first, then the name, then the time."""

    @pytest.mark.parametrize('wanted', ['', TALK])
    @pytest.mark.parametrize(
        ('right', 'own'), [('talk.ipynb', 'zz.ipynb'), ('My answers.ipynb', 'talk.ipynb')]
    )
    @pytest.mark.parametrize(
        ('place', 'count'),
        [('Ann_311_assignsubmission_file/{1}', 1), ('ann_1001_5600{0}_{1}', 2), ('ann/{1}', 1)],
        ids=['moodle', 'canvas', 'repository'],
    )
    def test_own_notes_do_not_replace_the_answers(
        self, place, count, right, own, wanted, gather, layout
    ):
        files = {place.format(1, right): GOOD, place.format(2, own): OWN}
        rows = gather(files, assignment=wanted)

        assert [data for data in taken(layout).values()] == [GOOD]
        assert [row.done for row in rows].count(TAKEN) == 1
        assert len(rows) == count

    @pytest.mark.parametrize(
        ('files', 'wanted', 'data', 'said'),
        [
            (
                {'talk.ipynb': notebook('talker'), f'old/{TALK}/x.ipynb': GOOD},
                TALK,
                GOOD,
                (
                    CHOSEN.format(
                        f'old/{TALK}/x.ipynb',
                        'talk.ipynb',
                        'it has the most',
                        f'old/{TALK}/x.ipynb',
                    ),
                    "the file was called 'x.ipynb'",
                ),
            ),
            (COPIES, '', RIGHT, (PLAIN,)),
            (COPIES, TALK, RIGHT, (PLAIN,)),
            ({f'{TALK}/talk.ipynb': DAMAGED, 'notes.ipynb': OWN}, '', DAMAGED, (CUT,)),
        ],
        ids=['most cells', 'name', 'name of the wanted one', 'damaged notebook with the name'],
    )
    def test_one_of_several_is_chosen(self, files, wanted, data, said, gather, layout):
        rows = gather({f'ann/{name}': one for name, one in files.items()}, assignment=wanted)

        assert taken(layout) == {f'ann/{TALK}/talk.ipynb': data}
        assert [(row.done, row.notes) for row in rows] == [(TAKEN, said)]

    @pytest.mark.parametrize(
        ('data', 'why'),
        [(OWN, STRANGE), (DAMAGED, CUT), (b'', EMPTY)],
        ids=['own', 'damaged', 'empty'],
    )
    def test_the_only_notebook_is_taken_without_a_cell(self, data, why, gather):
        rows = gather({'ann/talk.ipynb': data, 'bob/work.ipynb': data}, assignment=TALK)

        assert [(row.student, row.done) for row in rows] == [('ann', TAKEN), ('bob', TAKEN)]
        assert all(row.notes[0] == why for row in rows)

    @pytest.mark.parametrize(
        ('others', 'why'),
        [
            ({'b.ipynb': OWN}, 'it is not the only notebook'),
            ({f'{LISTEN}/listen.ipynb': OTHER}, f'listen.ipynb belongs to {LISTEN}'),
        ],
    )
    def test_one_of_several_without_a_cell_is_not_guessed(self, others, why, gather, layout):
        """Without a cell or the name of the assignment, only a single notebook is taken."""
        files = {'ann/a.ipynb': OWN, **{f'ann/{name}': data for name, data in others.items()}}

        (row,) = gather(files, assignment=TALK)

        assert (row.student, row.done) == ('ann', LEFT)
        assert why in row.notes[0]
        assert not layout.submitted.exists()

    def test_an_attempt_without_a_cell_does_not_replace_an_earlier_one(self, gather, layout):
        at = '+2026-03-0{} 12:00:00.000000 UTC+x/talk.ipynb'
        files = {
            f'ann+{TALK}{at.format(day)}': data
            for day, data in ((1, notebook('talker')), (2, GOOD), (3, OWN))
        }

        rows = gather(files)

        assert taken(layout)[f'ann/{TALK}/talk.ipynb'] == GOOD
        assert [row.done for row in rows] == [LEFT, TAKEN, LEFT]
        assert [row.notes[0] for row in rows] == [
            'a newer notebook was collected',
            'the newest of 3 attempts with a cell of the assignment',
            'a different notebook was collected',
        ]


def zipped(files: dict[str, bytes]) -> bytes:
    file = io.BytesIO()
    packed(file, files)
    return file.getvalue()


def patched(mark: bytes, offset: int, value: bytes) -> bytes:
    """Return a zip with a notebook, with bytes overwritten at an offset from the last mark."""
    data = bytearray(zipped({'talk.ipynb': GOOD, 'é': b''}))
    at = data.rindex(mark) + offset
    data[at : at + len(value)] = value
    return bytes(data)


HOSTILE = {
    'utf-8': patched('é'.encode(), 0, b'\xff\xfe'),
    'no name': patched(b'PK\1\2', 28, b'\0\0\2\0'),  # The name becomes an extra field.
    'offset': patched(b'PK\5\6', 16, b'\xff\xff'),  # All entries seem to start before the file.
}
"""Zips that Python's module for zips answers with different errors."""


class TestPackedWork:
    """Notebooks in zip files, or with another ending, are found if no other has the answers."""

    DEEP = zipped({'c.zip': zipped({'b.zip': zipped({'talk.ipynb': GOOD})})})

    @pytest.mark.parametrize(
        ('name', 'data'),
        [
            ('hw.ZIP', zipped({f'work/{TALK}/talk.ipynb': GOOD, '__MACOSX/._talk.ipynb': OWN})),
            ('a.zip', zipped({'b.zip': zipped({'talk.ipynb': GOOD}), 'c.zip': b'PK'})),
            ('a.zip', zipped({'listen.ipynb': OTHER, 'talk.ipynb.txt': GOOD})),
            ('talk.ipynb.txt', GOOD),
            ('talk (1).ipynb.json', GOOD),
            ('answers.json', GOOD),
        ],
        ids=['folder', 'zip in zip', 'text in zip', 'text', 'browser', 'json'],
    )
    @pytest.mark.parametrize('how', ['{}_5_assignsubmission_file/{}', '{}_1001_55_{}', '{}/{}'])
    def test_it_is_taken(self, how, name, data, gather, layout):
        files = {how.format('Ann', name): data, how.format('Ann', 'notes.txt'): b''}

        gather(files, packed, assignment=TALK)

        assert list(taken(layout).values()) == [GOOD]

    @pytest.mark.parametrize(
        ('name', 'data', 'why'),
        [
            ('a.zip', zipped({'x.pdf': b'%PDF'}), 'no notebook, only a.zip'),
            (
                'a.zip',
                b'PK',
                'a.zip: a damaged zip file (File is not a zip file); ask the student to ',
            ),
            ('a.zip', DEEP, 'no notebook, only a.zip'),
            ('a.zip', zipped({'../talk.ipynb': GOOD}), 'a.zip/../talk.ipynb: a path that leads'),
            (
                'a.zip',
                zipped({f'{n}.txt': b'' for n in range(2001)}),
                'a.zip: a zip file with too many',
            ),
            ('settings.json', b'{"cells": []}', 'no notebook, only settings.json'),
            ('a.rar', b'Rar!', 'no notebook, only a.rar'),
        ],
        ids=['other', 'damaged', 'deep', 'upwards', 'many', 'json', 'rar'],
    )
    def test_what_cannot_be_opened_is_reported(self, name, data, why, gather):
        (row,) = gather({f'ann/{name}': data})

        assert (row.student, row.done) == ('ann', LEFT)
        assert row.notes[0].startswith(why)
        assert ('no notebook' in why) == (selection.ASK in row.notes)

    @pytest.mark.parametrize('name', HOSTILE)
    def test_a_hostile_zip_stops_nobody_else(self, name, gather, tmp_path, layout):
        ann, bob = gather({'ann/a.zip': HOSTILE[name], 'bob/talk.ipynb': GOOD}, packed)

        assert (ann.student, ann.done) == ('ann', TAKEN if name == 'no name' else LEFT)
        assert bob == Row('bob', TALK, 'bob', TAKEN)

    @pytest.mark.parametrize(('name', 'place'), [('no name', ''), ('offset', 'talk.ipynb')])
    def test_a_hostile_name_in_a_download_is_one_row(self, name, place, tmp_path, layout):
        (tmp_path / 's.zip').write_bytes(HOSTILE[name])

        rows = collect(tmp_path / 's.zip', layout, layout.submitted)

        assert place in [row.place for row in rows if row.done == LEFT]

    def test_a_hostile_name_that_cannot_be_read_is_one_sentence(self, tmp_path, layout):
        (tmp_path / 's.zip').write_bytes(HOSTILE['utf-8'])

        with pytest.raises(UnusableUploadError, match='the zip file cannot be read'):
            collect(tmp_path / 's.zip', layout, layout.submitted)

    def test_notebooks_outside_of_a_zip_come_first(self, gather, layout):
        """A zip next to a notebook may contain an old copy, or the whole course."""
        old = zipped({'talk.ipynb': GOOD})

        (row,) = gather({'ann/old.zip': old, 'ann/talk.ipynb': notebook('talker')})

        assert row.notes == ()
        assert list(taken(layout).values()) == [notebook('talker')]

    @pytest.mark.parametrize('name', ['notes.ipynb', 'talk.ipynb'])
    def test_answers_in_a_zip_next_to_other_work_are_found(self, name, gather, layout):
        gather({f'ann/{name}': OWN, 'ann/lesson.zip': zipped({'talk.ipynb': GOOD})})

        assert list(taken(layout).values()) == [GOOD]

    def test_a_damaged_zip_next_to_other_work_is_reported(self, gather):
        (row,) = gather({'ann/notes.ipynb': OWN, 'ann/lesson.zip': b'PK'}, assignment=TALK)

        assert row.done == LEFT
        assert any('lesson.zip: a damaged zip file' in note for note in row.notes)

    def test_one_zip_too_many_is_reported(self, gather):
        files = {f'ann/{n:02}.zip': zipped({'x.pdf': b'%PDF'}) for n in range(11)}

        (row,) = gather(files)

        assert row.notes == ('10.zip: not opened: only the first 10 zip files are opened',)

    def test_of_equal_names_in_two_zips_the_path_says_which(self, gather):
        files = {f'ann/{name}.zip': zipped({'talk.ipynb': GOOD}) for name in 'ab'}

        (row,) = gather(files)

        equal = 'a.zip/talk.ipynb', 'b.zip/talk.ipynb', 'they have equally many'
        assert row.notes == (CHOSEN.format(*equal, 'a.zip/talk.ipynb'),)

    def test_a_large_file_in_a_zip_is_refused(self, gather, monkeypatch):
        bounds = deliveries.IN_ZIP._replace(file_bytes=len(GOOD) - 1)
        monkeypatch.setattr(deliveries, 'IN_ZIP', bounds)

        (row,) = gather({'ann/a.zip': zipped({'talk.ipynb': GOOD})})

        assert row.notes[0].startswith('a.zip/talk.ipynb: more than')


class TestBounds:
    @pytest.mark.slow
    def test_a_class_is_not_held_in_memory(self, gather):
        large = json.dumps({**json.loads(GOOD), 'metadata': {'x': '.' * (4 << 20)}}).encode()
        tracemalloc.start()
        try:
            rows = gather({f's{n}/talk.ipynb': large for n in range(16)}, packed)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()

        assert [row.done for row in rows] == [TAKEN] * 16
        assert peak < 8 * len(large)

    @pytest.mark.parametrize('how', [packed, laid])
    def test_too_much_of_everything_is_one_sentence(self, how, gather, layout, monkeypatch):
        files = {f's{n}/talk.ipynb': GOOD for n in range(9)}
        limit(monkeypatch, whole_bytes=8 * len(GOOD))

        with pytest.raises(UnusableUploadError, match='of a class, got more than 0 MiB'):
            gather(files, how)
        assert not layout.submitted.exists()

        limit(monkeypatch, whole_bytes=9 * len(GOOD))
        assert {row.done for row in gather(files, how)} == {TAKEN}

    def test_what_is_too_large_when_unpacked_is_counted(self, gather, monkeypatch):
        limit(monkeypatch, file_bytes=1 << 20, whole_bytes=8 << 20)

        with pytest.raises(UnusableUploadError, match='of a class, got more than 8 MiB'):
            gather({f's{n}/x.ipynb': b' ' * (5 << 20) for n in range(9)}, packed)

    def test_of_very_many_notebooks_the_likely_ones_are_looked_at(self, gather):
        files = {f'ann/{n:03}.ipynb': OWN for n in range(selection.MOST_NOTEBOOKS + 20)}
        rows = gather({**files, f'ann/z/{TALK}/talk.ipynb': GOOD})

        assert sorted(row.done for row in rows) == [LEFT, TAKEN]
        (left,) = [row for row in rows if row.done == LEFT]
        assert f'not read: only the first {selection.MOST_NOTEBOOKS} notebooks' in left.notes[0]
        assert left.notes[0].endswith('18 more')

    def test_one_student_has_not_the_share_of_a_class(self, gather, monkeypatch):
        monkeypatch.setattr(selection, 'MOST_BYTES_EACH', 3 * len(GOOD))
        rows = gather({f'ann/{n}/talk.ipynb': GOOD for n in range(9)} | {'bob/talk.ipynb': GOOD})

        assert sorted(row.done for row in rows) == [LEFT, TAKEN, TAKEN]
        assert any('not read: only the first 3 notebooks' in '; '.join(row.notes) for row in rows)

    def test_a_notebook_that_is_too_large_is_reported_beside_the_others(self, gather, monkeypatch):
        limit(monkeypatch, file_bytes=2000)
        files = {f'ann/{TALK}/talk.ipynb': b' ' * 3000, f'ann/{LISTEN}/listen.ipynb': OTHER}

        rows = gather(files, packed)

        assert sorted((row.student, row.done) for row in rows) == [('ann', LEFT), ('ann', TAKEN)]
        assert any(row.notes[0].startswith(f'{TALK}/talk.ipynb: more than') for row in rows)

    def test_refused_files_of_one_entry_are_one_line(self, tmp_path, layout):
        source = laid(tmp_path / 's', {'ann/talk.ipynb': GOOD, 'bob/talk.ipynb': GOOD})
        for n in range(9):
            (source / 'ann' / f'link{n}').symlink_to('talk.ipynb')

        rows = collect(source, layout, layout.submitted)

        assert len(rows) == 3
        assert notes(rows)['ann/link0'] == (
            'a link or a special file',
            'and 8 more in the same folder',
        )
