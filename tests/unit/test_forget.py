"""``forget`` lists all data about a student, and removes it with ``--yes``."""

from argparse import Namespace
from unittest.mock import Mock

from collect_sources import (
    CANVAS,
    configure,
    GOOD,
    laid,
    notebook,
    packed,
    TALK,
)
from export_world import submission
import pytest

from autograder import __main__ as command
from autograder.classroom.collected import read_collected
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import last_results
from autograder.collect.copy_notebooks import collect
from autograder.commands import forget, OK


@pytest.fixture
def course(gather, here, tmp_path):
    """Return a course with a class from Canvas, without a gradebook."""
    gather(CANVAS, packed)
    return configure(here.root, f'sqlite:///{tmp_path}/none.db')


def students(course):
    return {one.student for one in read_collected(course)}


def test_list_has_everything_and_changes_nothing(course, capsys):
    """The submission comes first, as it is removed first."""
    laid(course.work, {'feedback/1001/x.html': b''})
    write_all_reports(course, TALK, [submission('1001')])

    assert command.main(['forget', 'EXAMPLEANN', '1001', '1004']) == OK
    assert capsys.readouterr().out.splitlines() == [
        '1001:',
        '  moved to autograder/_work/forgotten so that it is not graded again: '
        'autograder/_work/submitted/1001',
        f'  reports: result and page of {TALK}',
        '  folder: autograder/_work/feedback/1001',
        f'  saved by collect: exampleann, {TALK}, exampleann_1001_55077_talk-1.ipynb',
        '1004:',
        f'  saved by collect: diaz, {TALK}, no notebook, only essay.pdf',
        'Nothing was removed. To remove all this, run the same command with --yes',
    ]
    assert students(course) >= {'1001', '1004'}
    assert (course.submitted / '1001').is_dir()
    assert not (course.work / 'forgotten').exists()


def test_everything_is_removed_and_the_submission_is_moved(course, capsys):
    laid(course.work, {'feedback/1001/x.html': b''})
    write_all_reports(course, TALK, [submission('1001'), submission('1002')])
    page = course.reports / TALK / 'class.html'
    assert 'essay.pdf' in page.read_text('utf-8')

    assert command.main(['forget', '1001', '1004', '--yes']) == OK
    said = capsys.readouterr().out
    assert 'Removed.' in said
    assert 'collect a download with their work again' in said
    assert students(course) == {'1002', '1003', '1005', '1006'}
    assert [one.student for one in last_results(course, TALK)] == ['1002']
    assert 'essay.pdf' not in page.read_text('utf-8')
    (moved,) = (course.work / 'forgotten').iterdir()
    assert (moved / TALK / 'talk.ipynb').is_file()
    assert not (course.work / 'feedback' / '1001').exists()
    assert command.main(['forget', '1001']) == command.USAGE
    assert 'Did you mean' in capsys.readouterr().err


def test_replaced_work_is_moved_even_if_nothing_else_is_left(course, gather, capsys):
    gather({'1001/talk.ipynb': notebook('talker', text='newer')})
    (course.submitted / '1001' / TALK / 'talk.ipynb').unlink()

    assert command.main(['forget', '1001', '--yes']) == OK
    assert 'not touched' not in capsys.readouterr().out
    assert not (course.submitted / '1001').exists()
    assert list((course.work / 'forgotten').rglob('talk-replaced.ipynb'))


def test_submission_is_moved_before_anything_else_fails(course, monkeypatch, capsys):
    """Otherwise the next grading would add the student again."""

    def full(*_, **__):
        raise OSError(28, 'No space left on device')

    monkeypatch.setattr(forget, 'save_collected', full)

    assert command.main(['forget', '1001', '--yes']) == command.USAGE
    assert 'the disk is full' in capsys.readouterr().err
    assert not (course.submitted / '1001').exists()


def test_shared_id_is_forgotten(course, tmp_path, capsys):
    """Two people with one name are a trace too, even if nothing of them was collected."""
    files = {f'Li Wei_{one}_assignsubmission_file/talk.ipynb': GOOD for one in (313, 314)}
    files['Ann_311_assignsubmission_file/talk.ipynb'] = GOOD
    collect(packed(tmp_path / 'm.zip', files), course, course.submitted)

    assert command.main(['forget', 'Li Wei', '--yes']) == OK
    assert '  saved by collect: two people have this id' in capsys.readouterr().out
    assert 'Li Wei' not in students(course)


def test_a_removal_that_failed_can_be_repeated_with_the_name(course, monkeypatch, capsys):
    write_all_reports(course, TALK, [submission('1001')])
    with monkeypatch.context() as broken:
        broken.setattr(forget, 'remove_entries', Mock(side_effect=OSError('disk')))
        with pytest.raises(OSError, match='disk'):
            forget.run(Namespace(students=['exampleann'], yes=True))

    assert command.main(['forget', 'exampleann', '--yes']) == OK
    assert '1001' not in students(course)
    assert not last_results(course, TALK)
