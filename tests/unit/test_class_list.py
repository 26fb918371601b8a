"""The class list and the extensions: missing students, more time, and refused files."""

from datetime import timedelta
import re

from collect_sources import (
    collect,
    GOOD,
    laid,
    LISTEN,
    TALK,
)
from export_world import submission
import pytest
from rich.console import Console

from autograder.classroom.collected import collected_names, read_collected, save_collected, Work
from autograder.classroom.pages import print_table, write_all_reports
from autograder.classroom.people import class_list, extensions, not_listed, read_people
from autograder.classroom.results_of_class import ClassResults, graded
from autograder.classroom.standing import MISSING, without_result
from autograder.classroom.statistics import class_numbers
from autograder.commands.stats import stats_text
from autograder.errors import GraderError
from autograder.exports.marks import AUTOMATIC, marks
from autograder.submission.inbox import student_id


@pytest.fixture
def listed(layout):
    """Return a course whose class has three students."""
    text = 'Student;name;Section\r\nann;Ann Example;1\r\nbob@x.example;;1\r\nzoe;Zoe Z;2\r\n'
    laid(layout.work, {'class_list.csv': b'\xef\xbb\xbf' + text.encode()})
    return layout


def test_ids_are_those_of_collect_and_other_columns_are_ignored(listed):
    assert class_list(listed) == {'ann': 'Ann Example', 'bob@x.example': '', 'zoe': 'Zoe Z'}


def test_names_of_the_list_are_shown_but_not_saved(listed):
    """The list's names replace those of the platform, which may shorten names."""
    names = {'zoe': 'zedzoe', 'eve': 'adamseve'}
    save_collected(listed, [Work(one, TALK, name) for one, name in names.items()])

    assert read_people(listed) == {'ann': 'Ann Example', 'zoe': 'Zoe Z', 'eve': 'adamseve'}
    assert collected_names(read_collected(listed)) == names


def test_a_student_without_a_submission_is_missing_and_has_no_mark(listed):
    here = ClassResults(TALK, (submission('ann'), submission('eve')))
    found = marks(listed, here, AUTOMATIC)

    assert [(one.student, one.points, one.status) for one in found[2:]] == [
        ('bob@x.example', None, MISSING),
        ('zoe', None, MISSING),
    ]
    assert found[3].max_points == 6.5
    assert not_listed(listed, ['ann', 'eve']) == ('eve',)


@pytest.mark.parametrize('column', ['name', 'id'])
def test_name_and_id_of_a_student_are_the_same_student(layout, column):
    """Both files accept the id that collect shows, and the name from which it is made."""
    name = 'Müller, Jörg'
    shown = {'name': name, 'id': student_id(name)}[column]
    hours = f'student,assignment,hours\n"{shown}",,48\n'.encode()
    names = f'student\n"{shown}"\n'.encode()
    laid(layout.work, {'class_list.csv': names, 'extensions.csv': hours})

    assert extensions(layout)[student_id(name), TALK] == timedelta(hours=48)
    for folder in (name, student_id(name)):  # an instructor may have created the folder
        assert without_result(layout, TALK, [submission(folder)]) == ()
        assert not_listed(layout, {folder}) == ()


def test_without_a_list_nobody_is_missing(layout):
    assert without_result(layout, TALK, [submission('ann')]) == ()
    assert not_listed(layout, ['ann']) == ()


def test_reports_and_statistics_name_who_is_missing(listed):
    missing = without_result(listed, TALK, [submission('ann')])
    console = Console(record=True, width=120, file=None)
    print_table(console, TALK, [submission('ann')], {}, missing)
    write_all_reports(listed, TALK, [submission('ann')])

    assert 'Nothing handed in.' in console.export_text()
    page = (listed.reports / TALK / 'class.html').read_text('utf-8')
    assert '<li>zoe (Zoe Z): Nothing handed in.</li>' in page
    numbers = class_numbers(listed, graded(listed, TALK)[0])
    assert '  missing: zoe: Nothing handed in.' in stats_text(numbers)
    assert numbers.marks.count == 1


@pytest.mark.parametrize(
    ('text', 'names'),
    [
        (
            'Student,ID,SIS Login ID,Section,Monitor (7)\n    Points Possible,,,,50\n'
            '"García, Katrin",1003,kg,One,37\n"Student, Test",9,,One,\n',
            {'1003': 'Katrin García'},
        ),
        (
            'First name,Last name,Email address,Groups\nKatrin,García,kg@x.example,\n',
            {'Katrin García': 'Katrin García'},
        ),
        ('student,id,section\nann,900,1\nbob,901,1\n', {'ann': '', 'bob': ''}),
    ],
    ids=['canvas', 'moodle', 'no canvas'],
)
def test_downloads_from_canvas_and_moodle_are_class_lists(layout, text, names):
    laid(layout.work, {'class_list.csv': text.encode()})

    assert class_list(layout) == names


@pytest.mark.parametrize(
    ('text', 'why'),
    [
        ('name\nann\n', 'there is no column student'),
        ('student\nann\nann\n', 'row 3: ann is in the list twice'),
        ('First name,Last name\nLi,Wei\nLi,Wei\n', 'row 3: Li Wei is .* add an id to both names'),
        ('student\n-\n', "row 2: the student id '-' has no letter or digit"),
        ('student,name\nann\n', 'line 2 has 1 fields, line 1 has 2'),
        ('student\nJ\xf6rg\n', 'not UTF-8; save it as CSV UTF-8'),
    ],
)
def test_a_wrong_list_is_refused_with_its_place(layout, text, why):
    """A list with an unreadable row is refused, because other students would seem missing."""
    laid(layout.work, {'class_list.csv': text.encode('latin-1')})

    with pytest.raises(GraderError, match=why):
        class_list(layout)


def test_extensions_are_hours_for_one_assignment_or_for_all(layout):
    """Without a file, the gradebook keeps its extensions; an empty file removes them."""
    assert extensions(layout) is None
    laid(layout.work, {'extensions.csv': b'student,assignment,hours\n'})
    assert extensions(layout) == {}

    text = 'student,assignment,hours\nann,,24\nann,talk,"1,5"\nzoe,04_listen,0\n'
    laid(layout.work, {'extensions.csv': text.encode()})
    found = extensions(layout)

    assert found['ann', TALK] == timedelta(hours=1.5)
    assert found['ann', LISTEN] == timedelta(hours=24)
    assert ('zoe', TALK) not in found


@pytest.mark.parametrize(
    ('row', 'why'),
    [
        ('ann,talkk,1', 'row 2: talkk: there is no such assignment'),
        ('ann,,two', "row 2: expected hours from 0 to 8784, got 'two'"),
        ('ann,talkk,1\nbob,,two', 'row 2: talkk'),
        ('ann,,-1', 'expected hours'),
        ('ann,,nan', 'expected hours'),
    ],
)
def test_a_wrong_extension_is_refused_with_its_place(gather, layout, row, why):
    """A misspelt name is refused, so that no student loses points."""
    laid(layout.work, {'extensions.csv': f'student,assignment,hours\n{row}\n'.encode()})

    with pytest.raises(GraderError, match=why):
        extensions(layout)
    with pytest.raises(GraderError, match=why):
        collect(
            laid(layout.root / 'class', {f'{name}/talk.ipynb': GOOD for name in ('ann', 'bob')}),
            layout,
            layout.submitted,
        )
    assert not layout.submitted.exists()


@pytest.mark.parametrize(
    ('listed', 'name', 'said'),
    [
        (True, 'Katrin Garcia', 'Did you mean "Katrin García"?'),
        (True, 'eve', 'Try: use the id in the class list, or delete the row'),
        (False, 'katrin garcia', 'Did you mean "Katrin García"?'),
        (False, 'eve', ''),
        (True, 'katrin  García', ''),
    ],
)
def test_extensions_are_for_students_of_the_course(layout, listed, name, said):
    """Without a class list, a student may be unknown because their work is still to come."""
    files = {'extensions.csv': f'student,assignment,hours\n{name},,48\n'.encode()}
    if listed:
        files['class_list.csv'] = 'student,name\n1003,Katrin García\n'.encode()
    laid(layout.work, files)
    save_collected(layout, [Work('1003', TALK, 'Katrin García')])

    if said:
        why = f'row 2: there is no student {name}. {said}'
        with pytest.raises(GraderError, match=re.escape(why)):
            extensions(layout)
    else:
        assert extensions(layout)['1003' if listed else name, TALK] == timedelta(hours=48)
