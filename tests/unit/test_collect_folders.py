"""Folders of students, and the names that determine how a class is read."""

from collect_sources import (
    collect,
    done,
    every_kind,
    GOOD,
    GRADESCOPE,
    kind,
    laid,
    LISTEN,
    MOODLE,
    notes,
    OTHER,
    packed,
    REPOSITORIES,
    table,
    TALK,
)
import pytest

from autograder.collect.deliveries import LEFT, TAKEN
from autograder.submission.reading import UnusableUploadError


class TestFolders:
    @pytest.mark.parametrize('how', [packed, laid])
    def test_repositories_lose_the_name_of_the_assignment(self, how, gather, layout):
        rows = gather(REPOSITORIES, how)

        assert {row.student: row.done for row in rows} == {'ann': TAKEN, 'bob': TAKEN, 'cho': LEFT}
        assert all("'talk-' was removed from the name" in row.notes for row in rows)
        assert not [path for path in layout.submitted.rglob('*') if '.git' in path.parts]

    @pytest.mark.parametrize('around', ['', 'ros2-week-7-submissions/'])
    def test_repositories_of_github_classroom(self, around, gather):
        """A repository with the whole course is named after the assignment and the student."""
        files = {}
        for student in ('ann-x', 'bob'):
            name = f'{around}ros2-week-7-{student}'
            files[f'{name}/.git/HEAD'] = b'ref'
            files[f'{name}/.github/workflows/classroom.yml'] = b'name: Autograding Tests'
            files[f'{name}/notebooks/{TALK}/talk.ipynb'] = GOOD
            files[f'{name}/notebooks/START_HERE.ipynb'] = b'{}'
        rows = gather(files, prefix='ros2-week-7-')

        taken = {(row.student, row.assignment) for row in rows if row.done == TAKEN}
        assert taken == {('ann-x', TALK), ('bob', TALK)}

    def test_a_repository_without_a_commit_is_in_the_table(self, tmp_path, layout):
        source = laid(tmp_path / 'r', {**REPOSITORIES, 'talk-dan/.git/HEAD': b'ref'})
        (source / 'talk-eva' / '.git').mkdir(parents=True)

        rows = collect(source, layout, layout.submitted)

        left = {row.student: row.notes[:1] for row in rows if row.done == LEFT}
        assert left == {
            'cho': ('no notebook, only README.md',),
            'dan': ('no file that can be read',),
            'eva': ('no file that can be read',),
        }

    def test_files_that_are_no_notebooks_are_in_the_table(self, gather):
        files = {'ann.ipynb': GOOD, 'bob.rar': b'Rar!', 'cy.py': b'x = 1', 'd.zip': b'PK'}
        rows = gather(files)

        assert table(rows) == {
            ('ann', 'ann.ipynb'): TAKEN,
            ('', 'bob.rar'): LEFT,
            ('', 'cy.py'): LEFT,
            ('', 'd.zip'): LEFT,
        }
        assert notes(rows)['d.zip'][0].startswith('a zip file. Try: collect it alone if it is a')

    def test_a_zip_with_a_folder_around_everything_is_a_class(self, gather):
        around = {'hw/ann/talk.ipynb': GOOD, 'hw/bob/x.ipynb': OTHER}
        flat = {'hw/cy.ipynb': GOOD, 'hw/dan.ipynb': GOOD}

        assert done(gather(around, packed)) == [('ann', TALK, TAKEN), ('bob', LISTEN, TAKEN)]
        assert done(gather(flat, packed)) == [('cy', TALK, TAKEN), ('dan', TALK, TAKEN)]

    @pytest.mark.parametrize(
        'files',
        [
            {f'ann/{TALK}/talk.ipynb': GOOD, f'ann/{LISTEN}/listen.ipynb': OTHER},
            {f'ann/notebooks/{TALK}/talk.ipynb': GOOD, 'ann/src/listen.ipynb': OTHER},
        ],
    )
    def test_one_students_folder_is_no_class(self, files, gather):
        assert done(gather(files, packed)) == [('ann', TALK, TAKEN), ('ann', LISTEN, TAKEN)]

    def test_folders_of_assignments_are_no_students(self, gather):
        rows = gather({f'{TALK}/talk.ipynb': GOOD, f'{LISTEN}/listen.ipynb': OTHER})

        assert {row.done for row in rows} == {LEFT}
        assert 'collect the folder above' in rows[0].notes[0]


class TestIdsOfFolders:
    """The id is the name of the folder, whatever the other folders are called."""

    @pytest.mark.parametrize(
        'names',
        [('2024-0001', '2024-0002'), ('smith-john', 'smith-anna'), ('talk-ann', 'talk-bob')],
    )
    def test_what_folders_share_stays(self, names, gather):
        for place in ('{}/talk.ipynb', f'{{}}/{TALK}/talk.ipynb'):
            rows = gather({place.format(name): GOOD for name in names})

            assert {row.student for row in rows} == set(names)

    @pytest.mark.parametrize('prefix', ['talk-', '03_talk-', '03-talk_', '03-Talk-', 'talk_'])
    @pytest.mark.parametrize('others', [(), ('talk-bob',), ('zoe',), ('talk-bob', 'ros2-cy')])
    def test_a_repository_loses_an_assignment_on_every_day(self, prefix, others, gather):
        names = (f'{prefix}ann', *others)
        work = {'.git/HEAD': b'ref', 'work/talk.ipynb': GOOD, 'src/x.py': b''}
        files = {f'{name}/{place}': data for name in names for place, data in work.items()}

        for how in (packed, laid):
            found = {row.place: row.student for row in gather(files, how)}
            assert found[f'{prefix}ann'] == 'ann'
            assert found.get('ros2-cy', 'ros2-cy') == 'ros2-cy'

    def test_the_longest_name_of_an_assignment_is_taken_off(self, gather, layout):
        laid(layout.notebooks, {'06_talk_more/talk_more.ipynb': OTHER})
        names = ('talk-more-ann', 'talk-bob', 'talk-', 'talkative-cy')
        rows = gather({f'{name}/.git/x': b'' for name in names})

        assert {row.student for row in rows} == {'ann', 'bob', 'talk-', 'talkative-cy'}

    def test_two_repositories_of_one_student_are_not_mixed(self, gather):
        """If a student has two repositories for one assignment, a person has to choose."""
        files = {
            'talk-ann/.git/HEAD': b'',
            'talk-ann/talk.ipynb': GOOD,
            'listen-ann/.git/HEAD': b'',
            'listen-ann/listen.ipynb': OTHER,
        }
        assert done(gather(files)) == [('ann', TALK, TAKEN), ('ann', LISTEN, TAKEN)]

        rows = gather({**files, 'listen-ann/talk.ipynb': GOOD})
        assert [row.done for row in rows if row.assignment == TALK] == [LEFT, LEFT]

    def test_a_prefix_is_for_folders(self, gather):
        """``--prefix`` is refused for platforms, which choose the names themselves."""
        with pytest.raises(UnusableUploadError, match='these are names from moodle'):
            gather(MOODLE, packed, prefix='Li ')


class TestStudentChosenNames:
    """Only names from the platform determine how a class is read."""

    FORGED = (
        b"submission_102:\n  :submitters:\n  - :sid: '1001'\n"
        b'  :created_at: 2020-01-01 00:00:00 Z\n'
    )

    def test_metadata_in_a_submission_is_one_of_its_files(self, gather):
        forged = {'assignment_9_export/submission_101/submission_metadata.yml': self.FORGED}
        expected = gather(GRADESCOPE, packed, write=False)

        assert gather({**forged, **GRADESCOPE}, packed, write=False) == expected
        assert {row.student for row in expected} == {
            '1001', '1003', 'bo@example.org', 'submission_103'
        }  # fmt: skip

    @pytest.mark.parametrize('files', [MOODLE, REPOSITORIES], ids=['moodle', 'repositories'])
    @pytest.mark.parametrize(
        'name',
        [
            'submission_metadata.yml',
            'submission_1/submission_metadata.yml',
            'Vic_1_assignsubmission_file_/talk.ipynb',
            f'vic+{TALK}+2026-03-01 12:00:00 UTC+x/talk.ipynb',
            'vic_1001_55001_talk.ipynb',
        ],
    )
    def test_names_of_other_systems_in_a_folder_decide_nothing(
        self, files, name, tmp_path, layout
    ):
        owner = next(iter(files)).partition('/')[0]
        honest, source = tmp_path / 'honest', tmp_path / 'source'
        laid(honest, files)
        laid(source, {**files, f'{owner}/{name}': self.FORGED})

        rows = collect(source, layout, layout.submitted, write=False)

        assert kind(source) == kind(honest)
        assert table(rows) == table(collect(honest, layout, layout.submitted, write=False))

    def test_one_folder_of_a_class_with_the_name_of_another_system_is_a_student(self, gather):
        """The platform that explains most of the names is chosen."""
        rows = gather({**REPOSITORIES, 'Vic_1_assignsubmission_file_/talk.ipynb': GOOD})

        assert [row.student for row in rows if row.done == TAKEN] == [
            'Vic_1_assignsubmission_file_', 'ann', 'bob'
        ]  # fmt: skip

    @pytest.mark.parametrize('wanted', ['', 'moodle'])
    def test_a_single_hand_in_does_not_decide_by_what_is_in_it(self, wanted, gather):
        files = {
            'Ann_311_assignsubmission_file/Bo_312_assignsubmission_file/talk.ipynb': GOOD,
            'Ann_311_assignsubmission_file/Cy_313_assignsubmission_file/talk.ipynb': GOOD,
        }

        assert {row.student for row in gather(files, packed, kind=wanted)} == {'Ann'}


MACOS = {'.DS_Store': b'Bud1', '._x': b'mac'}


@every_kind
@pytest.mark.parametrize('how', [packed, laid])
@pytest.mark.parametrize('around', ['', 'unpacked/'])
def test_what_macos_and_jupyter_leave_is_as_if_it_were_not_there(
    files, expected, how, around, tmp_path, layout
):
    again = dict(files)
    if around and not any(name.startswith(('c/', 'assignment_9')) for name in files):
        again = {f'{around}{name}': data for name, data in files.items()}
    noise = {'__MACOSX/._unpacked': b'mac'}
    for name in again:
        above, _, last = name.rpartition('/')
        above = f'{above}/' if above else ''
        noise |= {f'{above}{file}': data for file, data in MACOS.items()}
        noise[f'{above}._{last}'] = b'mac'
        noise[f'__MACOSX/{above}._{last}'] = b'mac'
        noise[f'{above}.ipynb_checkpoints/talk-checkpoint.ipynb'] = GOOD
    plain, source = how(tmp_path / 'plain', files), how(tmp_path / 'source', {**noise, **again})

    rows = collect(source, layout, layout.submitted, write=False)

    assert kind(source) == kind(plain) == expected
    assert rows == collect(plain, layout, layout.submitted, write=False)


class TestNamedKind:
    @pytest.mark.parametrize('wanted', ['canvas', 'moodle', 'gradescope', 'exchange', 'folder'])
    def test_a_source_that_is_of_another_is_refused(self, wanted, gather):
        with pytest.raises(UnusableUploadError) as caught:
            gather({'roster.csv': b'', 'grades.csv': b''}, kind=wanted)

        assert f'expected submissions of kind {wanted} (' in caught.value.what
        assert 'got: grades.csv, roster.csv.' in caught.value.what

    def test_what_is_in_a_folder_around_everything_is_named(self, gather):
        with pytest.raises(UnusableUploadError, match=r'got: a\.pdf, b\.pdf, c\.pdf and 2 more'):
            gather({f'class/{name}.pdf': b'%PDF' for name in 'abcde'}, kind='moodle')

    def test_an_empty_source_is_refused(self, tmp_path, layout):
        """An empty source is refused, because it is usually the wrong folder."""
        (tmp_path / 's').mkdir()

        with pytest.raises(UnusableUploadError, match='got: nothing'):
            collect(tmp_path / 's', layout, layout.submitted, kind='folder')

    def test_a_few_names_of_a_kind_are_enough(self, gather):
        files = {f'notes_{n}.txt': b'' for n in range(9)}
        rows = gather({**files, 'ann_1001_55_talk.ipynb': GOOD}, kind='canvas')

        assert len(rows) == 10
        assert table(rows)['1001', 'ann_1001_55_talk.ipynb'] == TAKEN
