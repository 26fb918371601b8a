"""
Canvas's gradebook: one column is filled, everything else is unchanged.

The rules are those of Canvas's own ``gradebook_exporter.rb`` and ``gradebook_importer.rb``: the
columns, the line ``Points Possible`` with ``(read only)``, the line with posting policies, ``EX``
and ``N/A``, and commas or semicolons.
"""

import csv
import io

import pytest

from autograder.classroom.standing import BY_HAND, REVIEW
from autograder.errors import GraderError
from autograder.exports import canvas
from autograder.exports.marks import Mark
from autograder.submission.inbox import student_id

HEADER = 'Student,ID,SIS User ID,SIS Login ID,Section,Notes,Quiz 1 (101),Talker (102),Final Score'
POLICY = ',,,,,,,Manual Posting,'
POSSIBLE = '    Points Possible,,,,,,10.00,6.50,(read only)'
ADA = '"Lovelace, Ada",11,s11,ada,"Sec 1, A","said ""hi""",5,,71.4'
BOB = '"Roberts, Bob",12,s12,bob@uni.example,Sec 2,,N/A,3.00,'
EVE = '"Adams, Eve",13,eve,e13,Sec 2,,,EX,'
TEST = '"Student, Test",14,,f00d,Sec 2,,,,'


def book(*lines, end='\n'):
    return end.join([HEADER, POLICY, POSSIBLE, *(lines or (ADA, BOB, EVE, TEST))] + ['']).encode()


def marks(**points):
    return [Mark(student, value, 6.5) for student, value in points.items()]


def fill(given, data=None, column='Talker (102)', scale=False):
    return canvas.fill(data or book(), 'grades.csv', column, given, scale)


def cells(data, delimiter=','):
    return list(csv.reader(io.StringIO(data.decode('utf-8-sig'), newline=''), delimiter=delimiter))


def test_one_column_is_filled_and_every_other_cell_stays():
    done = fill(marks(ada=6.25))
    before, after = cells(book()), cells(done.data)

    changed = [
        (row, column)
        for row, (one, two) in enumerate(zip(before, after))
        for column, (old, new) in enumerate(zip(one, two))
        if old != new
    ]
    assert len(before) == len(after)
    assert changed == [(3, 7)]
    assert after[3][7] == '6.25'
    assert (done.filled, done.left_out, done.untouched) == (1, [], 3)


@pytest.mark.parametrize('student', ['ada', 's11', '11'])
def test_a_student_is_found_by_any_id(student):
    assert cells(fill([Mark(student, 1.0, 6.5)]).data)[3][7] == '1'


@pytest.mark.parametrize('login', ["o'neil@uni.example", 'bob+ros@uni.example'])
def test_an_id_that_collect_had_to_change_is_found(login):
    """The export changes an id that nbgrader cannot use in the same way as ``collect`` does."""
    data = book(ADA, BOB.replace('bob@uni.example', login))
    assert cells(fill([Mark(student_id(login), 1.0, 6.5)], data).data)[4][7] == '1'


@pytest.mark.parametrize('student', ['Lovelace, Ada', 'ADA', 'ad', 'adaa', ''])
def test_nobody_is_guessed(student):
    done = fill([Mark(student, 1.0, 6.5)])

    assert cells(done.data) == cells(book())
    assert done.left_out == [(student, 'Canvas has no such SIS Login ID, SIS User ID, ID')]


TWICE = book(ADA, '"Else, Some",99,,s11,Sec 2,,,,')


@pytest.mark.parametrize(
    ('given', 'data', 'why'),
    [
        (marks(s11=1.0), TWICE, ['lines 4, 5 have this id']),
        # If two ids match the same line, a person has to choose.
        (
            marks(ada=1.0, s11=2.0),
            book(),
            ['ada and s11 match the same row of Canvas, line 4'] * 2,
        ),
        ([Mark('ada', None, 6.5, REVIEW)], book(), ['for review']),
        (
            [Mark('bob@uni.example', None, 6.5, BY_HAND)],
            book(),
            ['to be graded by hand; Canvas keeps 3.00'],
        ),
        (marks(eve=6.5), book(), ['is excused in Canvas']),
    ],
    ids=['id of two lines', 'two ids of a line', 'for review', 'by hand', 'excused'],
)
def test_mark_that_cannot_be_entered_leaves_the_cell_as_it_is(given, data, why):
    done = fill(given, data)

    assert cells(done.data) == cells(data)
    assert done.left_out == [(one.student, said) for one, said in zip(given, why)]


def test_what_is_replaced_is_reported():
    """A replaced mark is reported, because a person may have entered it."""
    done = fill([Mark('bob@uni.example', 4.0, 6.5)])

    assert done.replaced == [('bob@uni.example', '3.00', '4')]
    assert 'replaced: bob@uni.example: 3.00 -> 4' in done.text()
    assert fill([Mark('bob@uni.example', 3.0, 6.5)]).replaced == []


@pytest.mark.parametrize('column', ['Talker (102)', 'Talker', '102'])
def test_the_column_is_named_by_header_title_or_id(column):
    assert fill(marks(ada=1.0), column=column).column == 'Talker (102)'


@pytest.mark.parametrize('column', ['Final Score', 'Notes', 'ID', 'Talkers', ''])
def test_only_an_assignment_can_be_filled(column):
    with pytest.raises(GraderError, match=r'Columns: Quiz 1 \(101\); Talker \(102\)'):
        fill(marks(ada=1.0), column=column)


def test_two_columns_of_one_title_need_the_id():
    twice = book().replace(b'Quiz 1 (101)', b'Talker (101)')

    with pytest.raises(
        GraderError, match=r'several columns match .+ Talker \(101\), Talker \(102\)'
    ):
        fill(marks(ada=1.0), twice, column='Talker')


def test_other_points_possible_are_refused_or_scaled():
    with pytest.raises(GraderError, match=r'expected 6\.5 points possible .* got 10'):
        fill(marks(ada=3.25), column='101')

    assert cells(fill(marks(ada=3.25), column='101', scale=True).data)[3][6] == '5'


def test_semicolons_commas_a_mark_and_line_ends_stay():
    text = book(ADA, end='\r\n').decode().replace(',', ';').replace('"Lovelace; Ada"', 'Ada')
    data = ('\ufeff' + text.replace('6.50', '6,50')).encode()
    done = fill(marks(ada=1.5), data)

    assert done.data.startswith(b'\xef\xbb\xbfStudent;ID')
    assert done.data.count(b'\r\n') == done.data.count(b'\n') == 4
    assert cells(done.data, ';')[3][7] == '1.5'


def test_first_and_last_name_may_have_columns_of_their_own():
    data = book().decode().replace('Student,', 'LastName,FirstName,', 1)
    data = data.replace('\n,', '\n,,').replace('Possible,', 'Possible,,').replace('"L', 'A,"L')
    lines = [line for line in data.splitlines() if not line.startswith(('"', '\n'))]
    assert cells(fill(marks(ada=1.0), '\n'.join([*lines, '']).encode()).data)[3][8] == '1'


@pytest.mark.parametrize(
    ('data', 'got'),
    [
        (b'', 'the first line'),
        (b'Name,Mark\nada,1\n', "the first line is 'Name,Mark'"),
        (HEADER.encode() + b'\n' + ADA.encode() + b'\n', 'there is no line "Points Possible"'),
        (book() + b'short,1\n', 'line 8 has 2 fields, line 1 has 9'),
        ('Schüler'.encode('utf-16'), 'not UTF-8'),
        (book() + b'"open,', 'not valid CSV'),
    ],
)
def test_another_file_is_refused(data, got):
    with pytest.raises(GraderError, match=got) as refused:
        fill(marks(ada=1.0), data or b'\n')

    assert 'Export Entire Gradebook' in str(refused.value)


@pytest.mark.parametrize('scale', [True, False])
def test_an_assignment_without_points_possible_takes_none(scale):
    """Scaling would change all marks to 0."""
    data = book().decode().replace('10.00', '0.00').encode()
    with pytest.raises(GraderError, match='got 0, which would scale all marks to 0') as error:
        fill(marks(ada=3.25), data, column='101', scale=scale)

    assert '--scale' not in error.value.fix
