"""
Moodle's grading worksheet: grades are filled in, everything else is unchanged.

The rules are those of Moodle's own ``gradingtable.php`` and ``importgradeslib.php``: the
identifier with the participant's number comes first and the maximum right after the grade;
headers may be in any language.
"""

import csv
import io

import pytest

from autograder.classroom.standing import MISSING
from autograder.errors import GraderError
from autograder.exports import moodle
from autograder.exports.marks import Mark

HEADER = (
    'Identifier,"Full name","Email address",Status,Grade,"Maximum Grade","Grade can be changed",'
    '"Last modified (submission)","Last modified (grade)","Feedback comments"'
)
ANN = '"Participant 311","Ann Example",a@x.example,Submitted,,6.50,Yes,-,-,"said ""hi"""'
BO = '"Participant 312","Bo Berg",b@x.example,Submitted,3.00,6.50,Yes,-,-,'
BO2 = '"Participant 313","Bo Berg",c@x.example,Submitted,,6.50,Yes,-,-,'


def sheet(*lines, header=HEADER):
    return '\n'.join([header, *(lines or (ANN, BO)), '']).encode()


def fill(marks, data=None, numbers=(), **more):
    given = [Mark(student, points, 6.5) for student, points in marks.items()]
    return moodle.fill(data or sheet(), 'grades.csv', given, dict(numbers), **more)


def grades(data):
    rows = list(csv.reader(io.StringIO(data.decode('utf-8'), newline='')))
    return {row[0]: row[4] for row in rows[1:]}


def test_only_grades_change():
    """Only grades change: Moodle compares the time of the last change, so it is kept."""
    done = fill({'Ann Example': 6.25})

    before, after = (list(csv.reader(io.StringIO(one.decode()))) for one in (sheet(), done.data))
    before[1][4] = '6.25'
    assert after == before
    assert (done.filled, done.untouched, done.left_out) == (1, 1, [])


@pytest.mark.parametrize('number', ['313', '313 999', '99 313'])
def test_numbers_of_collect_tell_people_with_one_name_apart(number):
    """
    The number of the participant decides; without it, neither namesake gets a mark.

    A student who handed in twice, in two activities, has two numbers.
    """
    data = sheet(BO, BO2)
    done = fill({'Bo Berg': 5.0}, data, {'Bo Berg': number})
    assert grades(done.data) == {'Participant 312': '3.00', 'Participant 313': '5'}

    refused = fill({'Bo Berg': 5.0}, data)
    assert refused.left_out == [('Bo Berg', 'lines 2, 3 have this id')]
    assert grades(refused.data) == grades(data)


def test_a_number_that_is_not_in_the_worksheet_matches_no_name():
    done = fill({'Bo Berg': 5.0}, numbers={'Bo Berg': '999'})

    assert done.left_out[0][0] == 'Bo Berg'
    assert done.filled == 0


@pytest.mark.parametrize('student', ['Bo Berg', 'b@x.example'])
def test_a_replaced_grade_is_reported(student):
    """A replaced grade is reported, because a person may have entered it."""
    assert fill({student: 4.0}).replaced == [(student, '3.00', '4')]


def test_a_missing_student_keeps_the_cell():
    done = moodle.fill(sheet(), 'g.csv', [Mark('Bo Berg', None, 6.5, MISSING)], {})

    assert done.left_out == [('Bo Berg', 'nothing handed in; Moodle keeps 3.00')]
    assert grades(done.data) == grades(sheet())


def test_a_worksheet_in_a_different_language_needs_the_name_of_its_column():
    data = sheet(header=HEADER.replace(',Grade,', ',Bewertung,'))
    with pytest.raises(GraderError, match=r"no column 'Grade'.* Bewertung, Maximum Grade"):
        fill({'Ann Example': 1.0}, data)

    filled = fill({'Ann Example': 1.0}, data, column='Bewertung')
    assert grades(filled.data)['Participant 311'] == '1'


def test_a_different_maximum_is_refused_or_scaled():
    """3.25 of 6.5 points are 5 of 10."""
    data = sheet(ANN.replace('6.50', '10.00'), BO.replace('6.50', '10.00'))
    with pytest.raises(GraderError, match=r'expected 6\.5 points possible for Grade, got 10'):
        fill({'Ann Example': 3.25}, data)

    scaled = fill({'Ann Example': 3.25}, data, scale=True)
    assert scaled.replaced == []
    assert grades(scaled.data)['Participant 311'] == '5'


@pytest.mark.parametrize(
    'data', [b'', b'Student,ID\nann,x\n', HEADER.encode(), 'J\xf6rg'.encode('latin-1')]
)
def test_a_different_file_is_refused(data):
    with pytest.raises(GraderError, match='not a grading worksheet') as refused:
        moodle.fill(data, 'g.csv', [], {})

    assert 'Download grading worksheet' in refused.value.fix
