"""Feedback pages get names that Canvas and Moodle recognise."""

import io
import re
import zipfile

from collect_sources import (
    CANVAS,
    MOODLE,
    packed,
    TALK,
)
import pytest

from autograder.classroom.collected import collected_work, save_collected, Work
from autograder.collect.copy_notebooks import collect
from autograder.exports.feedback_zip import feedback_zip, name_in_zip


def of_canvas(name):
    """Return the user and the attachment, read from a file name as Canvas does."""
    parts = name.split('_')
    assert not parts[-1].startswith('link')
    return [part for part in parts if re.fullmatch(r'\d+', part)][:2]


def of_moodle(name):
    """Return the number and the kind of a submission, read from a file name as Moodle does."""
    return name.split('_', 4)[1:4]


def names_of(layout, kind):
    """Return the file name in the zip for each collected student."""
    found = collected_work(layout, TALK)
    assert {one.kind for one in found.values()} == {kind}
    return {student: name_in_zip(student, one) for student, one in found.items()}


def test_canvas_finds_user_and_attachment_of_what_was_collected(gather, layout):
    """Canvas recognises every name, even if work was late or was handed in twice."""
    gather(CANVAS, packed)
    names = names_of(layout, 'canvas')

    assert names['1001'] == 'exampleann_1001_55077_talk-1_feedback.html'
    assert {student: of_canvas(name)[0] for student, name in names.items()} == {
        student: student for student in ('1001', '1002', '1005')
    }


@pytest.mark.parametrize('download', ['folders', 'files'])
def test_moodle_finds_the_participant(gather, layout, download):
    files = MOODLE
    if download == 'files':
        files = {
            name.replace('file_/', 'file_').replace('file/', 'file_'): data
            for name, data in MOODLE.items()
        }
    gather(files, packed)
    names = names_of(layout, 'moodle')

    assert of_moodle(names['Ann Example']) == ['311', 'assignsubmission', 'file']
    assert names['Ann Example'].endswith('_file_feedback.html')


def test_file_named_link_is_renamed_for_canvas():
    """A last part that begins with link is renamed, because Canvas reads it as a web address."""
    name = name_in_zip('7', Work('7', kind='canvas', place='ann_7_88_my_link.ipynb'))

    assert of_canvas(name) == ['7', '88']


def test_other_students_have_folders_of_their_own():
    """An id cannot become a path out of the zip, and equal pages give equal bytes."""
    data = feedback_zip({'../x': b'<p>', 'ann': b'<p>'}, {})

    assert data == feedback_zip({'ann': b'<p>', '../x': b'<p>'}, {})
    names = zipfile.ZipFile(io.BytesIO(data)).namelist()
    assert sorted(names) == ['ann/feedback.html', '~2E.~2Fx/feedback.html']


def test_a_dry_run_saves_no_names_and_forget_removes_them(tmp_path, layout):
    source = packed(tmp_path / 'c.zip', CANVAS)
    collect(source, layout, layout.submitted, write=False)
    assert not layout.collected.exists()

    collect(source, layout, layout.submitted)
    save_collected(layout, without=[collected_work(layout, TALK)['1001']])
    assert set(collected_work(layout, TALK)) == {'1002', '1005'}
