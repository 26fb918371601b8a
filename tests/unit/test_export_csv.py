"""
CSV by the rules of RFC 4180, section 2, and safe from formulas.

The rules are checked by a reader of their own, letter by letter: Python's csv module forgives.
"""

from __future__ import annotations

import csv
import io
import re

from export_world import CLASS, EVIL, FORMULA, submission
from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.results_of_class import ClassResults
from autograder.exports.marks import automatic, BY_HAND, Mark
from autograder.exports.table import (
    checks_csv,
    csv_bytes,
    FORMULA_STARTS,
    harmless,
    marks_csv,
)

FIELD = re.compile(r'"(?:[^"]|"")*"|[^",\r\n]*')
"""``escaped`` or ``non-escaped`` of the grammar; TEXTDATA is wider, as the file is UTF-8."""


def rfc4180(data):
    """Return the rows of a file, refusing whatever the grammar does not allow."""
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


def marks_of(graded):
    """Return the table of marks as dictionaries."""
    given_marks = [automatic(result) for result in graded.results]
    rows = rfc4180(marks_csv([(graded, given_marks)], {}))
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def test_each_submission_has_a_line():
    """With numbers as numbers."""
    ann, bob, _, hostile = marks_of(CLASS)

    assert (ann['points'], ann['max_points'], ann['status']) == ('2', '6.5', 'graded')
    assert ann['first_cause'] == 'a typo (observed: none)'
    assert bob['points'] == '5'
    assert hostile['student'].startswith('x<')


def test_for_review_is_an_empty_cell():
    """Never a zero."""
    eve = marks_of(CLASS)[2]

    assert (eve['student'], eve['status'], eve['points']) == ('eve', 'for review', '')


def test_checks_of_a_submission_for_review_have_no_points():
    """The verdicts that there are can be read."""
    rows = rfc4180(checks_csv([CLASS]))
    lines = [dict(zip(rows[0], row)) for row in rows[1:]]

    assert {line['points'] for line in lines if line['student'] == 'eve'} == {''}
    assert [line['verdict'] for line in lines if line['student'] == 'ann'] == [
        'PASSED',
        'FAILED',
        'NOT_RUN',
    ]


def test_a_mark_that_is_not_complete_is_an_empty_cell():
    """What is to be graded by hand has no mark yet."""
    graded = ClassResults('01_talker', (submission(),))
    rows = rfc4180(
        marks_csv([(graded, [Mark('ann', None, 8.0, BY_HAND)])], {'ann': 'Ann Example'})
    )

    assert rows[1][:6] == ['01_talker', 'ann', 'Ann Example', 'to be graded by hand', '', '8']


@pytest.mark.parametrize('start', FORMULA_STARTS)
def test_no_cell_begins_like_a_formula(start):
    """Each of the signs that OWASP lists for CSV injection, and their full-width forms."""
    for text in (f'{start}1+1', f' {start}cmd', f'\n{start}x', start):
        ((shown,),) = rfc4180(csv_bytes(['a'], [[text]]))[1:]
        assert shown.startswith("'"), repr(text)


def test_hostile_words_stay_in_their_cell():
    """Formulas, quotes, line breaks and control characters in names and causes."""
    for table in (
        marks_csv([(CLASS, [automatic(one) for one in CLASS.results])], {'ann': EVIL}),
        checks_csv([CLASS]),
    ):
        for row in rfc4180(table):
            for cell in row:
                assert not cell.lstrip().startswith(FORMULA_STARTS)
                assert '\x00' not in cell
                assert '\x1b' not in cell
    assert harmless(FORMULA) == f"'{FORMULA}"
    assert harmless('a-b') == 'a-b'


@settings(deadline=None, max_examples=40)
@given(strategies.lists(strategies.lists(strategies.text(), min_size=2, max_size=2), max_size=5))
def test_any_text_keeps_the_grammar(rows):
    """And Python's reader gets the same cells."""
    data = csv_bytes(['a', 'b'], rows)

    read = rfc4180(data)
    assert len(read) == len(rows) + 1
    assert read == list(csv.reader(io.StringIO(data.decode('utf-8'), newline='')))


def test_the_hostile_text_is_hostile():
    """Else the tests above would prove nothing."""
    assert FORMULA in EVIL
    assert '\x00' in EVIL


@pytest.mark.parametrize(
    'text', ['x;=1+1', 'x; =cmd', 'a\t@b', 'a\n-b', 'a;"=1', 'x\xa0;=1', 'x\x85;\u2003=1']
)
def test_no_cell_of_a_spreadsheet_that_parts_at_semicolons_begins_like_a_formula(text):
    """Where the comma is the decimal point; quotes do not stop it."""
    line = csv_bytes(['a', 'b'], [['1', text]]).decode().split('\r\n', 1)[1]

    for cell in re.split('[;\t\n]', line)[1:]:
        assert not cell.strip(' "').startswith(FORMULA_STARTS), line


def test_ordinary_words_with_semicolons_stay():
    """Flags are joined with them."""
    ((shown,),) = rfc4180(csv_bytes(['a'], [['one; two - three; 4 = 4']]))[1:]

    assert shown == 'one; two - three; 4 = 4'
