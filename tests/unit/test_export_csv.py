"""
CSV that follows RFC 4180, section 2, and contains no formulas.

A separate parser checks the rules character by character, because Python's csv module is lenient.
"""

import csv
from dataclasses import replace
import io
import re

from export_world import ABSENT, CLASS, EVIL, FORMULA, marked, submission
from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.standing import BY_HAND
from autograder.exports.marks import automatic, Mark
from autograder.exports.table import (
    checks_csv,
    csv_bytes,
    FORMULA_STARTS,
    harmless,
    marks_csv,
)

FIELD = re.compile(r'"(?:[^"]|"")*"|[^",\r\n]*')
"""``escaped`` or ``non-escaped`` in the grammar; TEXTDATA has more, as the file is UTF-8."""


def rfc4180(data):
    """Return the rows of a file; refuse anything that the grammar does not allow."""
    text, place, rows = data.decode('utf-8'), 0, [[]]
    while place < len(text):
        field = FIELD.match(text, place)
        place = field.end()
        rows[-1].append(
            field[0][1:-1].replace('""', '"') if field[0].startswith('"') else field[0]
        )
        if text.startswith(',', place):
            place += 1
        else:
            assert text.startswith('\r\n', place), f'no line end at {place}: {text[place:][:20]!r}'
            place += 2
            rows.append([])
    assert rows.pop() == [], 'the last line has no end'
    assert {len(row) for row in rows} == {len(rows[0])}, 'lines of different lengths'
    return rows


def table(data):
    names, *rows = rfc4180(data)
    return [dict(zip(names, row)) for row in rows]


def test_each_submission_has_a_row():
    ann, bob, eve, hostile = table(marks_csv(marked(), {}))

    assert (ann['points'], ann['max_points'], ann['status']) == ('2', '6.5', 'graded')
    assert ann['first_cause'] == 'a typo (observed: none)'
    assert bob['points'] == '5'
    assert hostile['student'].startswith('x<')
    assert (eve['student'], eve['status'], eve['points']) == ('eve', 'for review', '')


def test_a_student_without_a_submission_has_a_row_without_points():
    late = replace(automatic(CLASS.results[0]), points=1.5, late_points=0.5)
    ann, zoe = table(marks_csv([late, ABSENT], {'zoe': 'Zoe Example'}))

    assert (zoe['student'], zoe['name'], zoe['status']) == ('zoe', 'Zoe Example', ABSENT.status)
    assert (zoe['points'], zoe['max_points'], zoe['late_points']) == ('', '6.5', '')
    assert (ann['points'], ann['late_points']) == ('1.5', '0.5')


def test_checks_of_a_submission_for_review_have_no_points():
    lines = table(checks_csv(marked()))

    assert {line['points'] for line in lines if line['student'] == 'eve'} == {''}
    assert [line['verdict'] for line in lines if line['student'] == 'ann'] == [
        'PASSED',
        'FAILED',
        'NOT_RUN',
    ]


def test_a_mark_that_is_not_complete_is_an_empty_cell():
    """A submission that waits for a manual grade has no mark."""
    mark = Mark('ann', None, 8.0, BY_HAND, assignment='01_talker', result=submission())
    rows = rfc4180(marks_csv([mark], {'ann': 'Ann Example'}))

    assert rows[1][:6] == ['01_talker', 'ann', 'Ann Example', 'to be graded by hand', '', '8']


@pytest.mark.parametrize('start', FORMULA_STARTS)
def test_no_cell_begins_like_a_formula(start):
    """No cell begins with a character that OWASP lists for CSV injection, or a full-width form."""
    for text in (f'{start}1+1', f' {start}cmd', f'\n{start}x', start):
        ((shown,),) = rfc4180(csv_bytes(['a'], [[text]]))[1:]
        assert shown.startswith("'"), repr(text)


def test_hostile_words_stay_in_their_cell():
    for data in (marks_csv(marked(), {'ann': EVIL}), checks_csv(marked())):
        for cell in (cell for row in rfc4180(data) for cell in row):
            assert not cell.lstrip().startswith(FORMULA_STARTS)
            assert '\x00' not in cell
            assert '\x1b' not in cell
    assert harmless(FORMULA) == f"'{FORMULA}"
    assert harmless('a-b') == 'a-b'


@settings(deadline=None, max_examples=40)
@given(strategies.lists(strategies.lists(strategies.text(), min_size=2, max_size=2), max_size=5))
def test_any_text_keeps_the_grammar(rows):
    data = csv_bytes(['a', 'b'], rows)

    read = rfc4180(data)
    assert len(read) == len(rows) + 1
    assert read == list(csv.reader(io.StringIO(data.decode('utf-8'), newline='')))


@pytest.mark.parametrize(
    'text', ['x;=1+1', 'x; =cmd', 'a\t@b', 'a\n-b', 'a;"=1', 'x\xa0;=1', 'x\x85;\u2003=1']
)
def test_no_cell_of_a_spreadsheet_that_parts_at_semicolons_begins_like_a_formula(text):
    """A spreadsheet that splits at semicolons, even in quotes, finds no formula."""
    line = csv_bytes(['a', 'b'], [['1', text]]).decode().split('\r\n', 1)[1]

    for cell in re.split('[;\t\n]', line)[1:]:
        assert not cell.strip(' "').startswith(FORMULA_STARTS), line


def test_ordinary_words_with_semicolons_stay():
    ((shown,),) = rfc4180(csv_bytes(['a'], [['one; two - three; 4 = 4']]))[1:]

    assert shown == 'one; two - three; 4 = 4'
