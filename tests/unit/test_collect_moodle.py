"""Moodle: names become ids, and two people with the same name are never confused."""

from functools import partial
from unittest.mock import Mock

from collect_sources import (
    GOOD,
    kind,
    laid,
    LISTEN,
    MOODLE,
    notebook,
    notes,
    OTHER,
    packed,
    table,
    taken,
    TALK,
)
import pytest

from autograder.classroom.collected import read_collected
from autograder.collect.copy_notebooks import collect
from autograder.collect.deliveries import LEFT, TAKEN
from autograder.errors import GraderError


@pytest.fixture
def gather(gather):
    """Return the function that collects files, which trusts no name, as the command does."""
    return partial(gather, trust_names=False)


class TestMoodle:
    """Moodle names folders, or files, ``NAME_NUMBER_assignsubmission_file``."""

    def test_names_become_ids(self, gather):
        """The name becomes the id, because the number changes with the assignment."""
        rows = gather(MOODLE, packed)

        done = {row.student: row.done for row in rows}
        assert done == {'Ann Example': TAKEN, 'Bo Berg': TAKEN, 'Li Wei': LEFT, 'Dee': LEFT}
        place = 'Dee_315_assignsubmission_onlinetext'
        assert notes(rows)[place] == ('an online text, which is not collected',)

    def test_files_without_folders_are_read(self, tmp_path, layout):
        files = {
            'Ann Example_311_assignsubmission_file_talk.ipynb': GOOD,
            'Bo Berg_312_assignsubmission_file_notes.pdf': b'%PDF',
            'Bo Berg_312_assignsubmission_file_talk.ipynb': GOOD,
            'Dee_315_assignsubmission_onlinetext_onlinetext.html': b'<p>hello',
        }
        source = packed(tmp_path / 'm.zip', files)

        rows = collect(source, layout, layout.submitted)

        assert kind(source) == 'moodle'
        assert table(rows) == {
            ('Ann Example', 'Ann Example_311_assignsubmission_file_talk.ipynb'): TAKEN,
            ('Bo Berg', 'Bo Berg_312_assignsubmission_file_notes.pdf'): LEFT,
            ('Bo Berg', 'Bo Berg_312_assignsubmission_file_talk.ipynb'): TAKEN,
            ('Dee', 'Dee_315_assignsubmission_onlinetext_onlinetext.html'): LEFT,
        }

    @staticmethod
    def of_moodle(*who, file='talk.ipynb', data=GOOD):
        """Return the files of a download with a notebook for each name."""
        return {f'{one}_assignsubmission_file/{file}': data for one in who}

    LISTENERS = partial(of_moodle, file='listen.ipynb', data=OTHER)

    def test_two_of_one_name_are_not_guessed(self, gather, layout):
        """Namesakes are left out, even if later only one of them hands in again."""
        first = self.of_moodle('Li Wei_313', 'Ann_311')
        both = self.of_moodle('Li Wei_313', 'Li Wei_314', 'Ann_311')
        later = self.LISTENERS('Li Wei_501', 'Ann_502')
        gather(first, packed)
        assert f'Li Wei/{TALK}/talk.ipynb' in taken(layout)

        for files in (both, later, first):
            of_li = [row for row in gather(files, packed) if row.student == 'Li Wei']
            assert {row.done for row in of_li} == {LEFT}
            assert all("two people are called 'Li Wei': unpack" in row.notes[0] for row in of_li)
        assert {name.split('/')[0] for name in taken(layout)} == {'Ann', 'Li Wei'}
        assert f'Li Wei/{LISTEN}/listen.ipynb' not in taken(layout)

    def test_names_of_their_own_help(self, gather):
        gather(self.of_moodle('Li Wei_313', 'Li Wei_314'), packed)

        rows = gather(self.of_moodle('Li Wei 2024-7_313', 'Li Wei 2024-9_314'), packed)

        assert [(row.student, row.done) for row in rows] == [
            ('Li Wei 2024-7', TAKEN),
            ('Li Wei 2024-9', TAKEN),
        ]

    def test_groups_are_downloaded_one_after_the_other(self, gather, layout):
        """If each download has one of two namesakes, the numbers differ, so both are left out."""
        gather(self.of_moodle('Li Wei_313', 'Ann_311'), packed)

        newer = notebook('talker', text='of the other Li Wei')
        (row,) = gather(self.of_moodle('Li Wei_314', data=newer), packed)

        assert row.done == LEFT
        assert row.notes[0].startswith(
            "perhaps a different 'Li Wei': number 314 in Moodle, earlier 313. Try: if Moodle has "
            'two assignments for this work, add --trust-names; '
        )
        assert taken(layout)[f'Li Wei/{TALK}/talk.ipynb'] == GOOD

    def test_a_second_activity_has_new_numbers(self, gather, layout):
        """The first download can then be collected again, and one student more is not trusted."""
        first = self.of_moodle('Ann_0', 'Bo_1', 'Cy_2', 'Dee_3')
        second = self.of_moodle('Ann_20', 'Bo_21', 'New_22')
        more = self.of_moodle('Ann_20', 'Bo_21', 'Cy_23')
        gather(first, packed)
        rows = gather(second, packed)
        for row, number in zip(rows, range(2)):
            said = f'number 2{number}, earlier {number}: taken as a second activity; '
            assert row.notes == (f'{said}perhaps a different {row.student!r}',)
        for files in (first, second):
            rows += gather(files, packed)
        assert LEFT not in {row.done for row in rows}

        rows = gather(more, packed)
        assert [row.student for row in rows if row.done == LEFT] == ['Cy']
        rows = gather(more, packed, trust_names=True)
        assert LEFT not in {row.done for row in rows}
        numbers = {one.student: one.number for one in read_collected(layout)}
        assert numbers == {'Ann': '0 20', 'Bo': '1 21', 'Cy': '2 23', 'Dee': '3', 'New': '22'}

    def test_folders_are_renamed_only_once(self, gather):
        """Later downloads have the same numbers; in another lesson, the name is not enough."""
        renamed = self.of_moodle('Li Wei 7_313', "O'Neil 8_314", 'Ann_311')
        later = self.of_moodle('Li Wei_313', "O'Neil_314", 'Ann_311', data=notebook('talker'))
        before = {row.student for row in gather(renamed, packed)}

        rows = gather(later, packed)
        assert {row.student for row in rows} == before
        assert "the name was 'Li Wei'" in notes(rows)['Li Wei_313_assignsubmission_file']
        (row,) = gather(self.LISTENERS('Li Wei_501'), packed)
        assert row.notes[0].startswith("two people are called 'Li Wei': unpack the zip")

    def test_another_lesson_has_other_numbers(self, gather, layout):
        """A student's number differs between lessons, and a dry run saves no numbers."""
        one, two = self.of_moodle('Ann_311', 'Bo_312'), self.LISTENERS('Ann_312', 'Bo_311')
        gather(one, packed, write=False)
        assert not layout.collected.exists()

        for files in (one, two):
            assert [row.done for row in gather(files, packed)] == [TAKEN, TAKEN]

    def test_a_memory_that_is_a_link_is_called_a_link(self, gather, layout):
        laid(layout.work, {'real.json': b'[]'})
        layout.collected.symlink_to(layout.work / 'real.json')

        with pytest.raises(GraderError, match='that collect has seen, got a symbolic link'):
            gather(MOODLE, packed)

    def test_a_memory_that_cannot_be_written_is_one_line(self, gather, layout, monkeypatch):
        monkeypatch.setattr(
            'autograder.classroom.tables.write_atomically',
            Mock(side_effect=OSError(28, 'No space left on device')),
        )

        rows = gather(MOODLE, packed)

        assert rows[0].place == str(layout.collected)
        what = 'names, numbers from Moodle and missing work'
        assert rows[0].notes == (f'{what} cannot be written: no space left on device',)
        assert f'Bo Berg/{TALK}/talk.ipynb' in taken(layout)

    def test_a_file_called_like_somebody_elses_stays_its_owners(self, gather):
        """Only the first number in a file name counts, because the student chose the rest."""
        files = {
            'Ann_311_assignsubmission_file_Bo_312_assignsubmission_file_talk.ipynb': GOOD,
            'Cy_313_assignsubmission_file_talk.ipynb': GOOD,
        }

        assert {row.student for row in gather(files, packed)} == {'Ann', 'Cy'}

    @pytest.mark.parametrize(
        ('name', 'why'),
        [
            ('Li Wei_314', "two people are called 'Li Wei': "),
            ('--_314', 'no letter or digit in the name'),
            ('Ann_314', 'an online text, which is not collected'),
        ],
    )
    def test_an_unclear_name_comes_before_a_wrong_type(self, name, why, gather):
        files = {
            'Li Wei_313_assignsubmission_file/talk.ipynb': GOOD,
            f'{name}_assignsubmission_onlinetext/onlinetext.html': b'<p>',
        }

        rows = gather(files, packed)

        assert notes(rows)[f'{name}_assignsubmission_onlinetext'][0].startswith(why)

    def test_file_and_text_of_one_student_are_two_lines(self, gather):
        """Two folders of one text are both in the table."""
        files = {
            'Ann_311_assignsubmission_file/talk.ipynb': GOOD,
            'Ann_311_assignsubmission_onlinetext/onlinetext.html': b'<p>see file',
            'Ann_311_assignsubmission_onlinetext_/onlinetext.html': b'<p>',
            'Default group_assignsubmission_file/talk.ipynb': GOOD,
        }

        rows = gather(files, packed)

        assert len(rows) == len(files)
        assert table(rows) == {
            ('Ann', 'Ann_311_assignsubmission_file'): TAKEN,
            ('Ann', 'Ann_311_assignsubmission_onlinetext'): LEFT,
            ('', 'Ann_311_assignsubmission_onlinetext_'): LEFT,
            ('', 'Default group_assignsubmission_file'): LEFT,
        }
