"""The text files of exams contain the texts of exactly the causes that the code names."""

import ast
import importlib
import re

import pytest

from autograder.errors import ExamInvalid
from autograder.exam.words import Causes
from autograder.layout import Layout

ROOT = Layout.here().root
TABLES = sorted([*ROOT.glob('autograder/exam/*.txt'), *ROOT.glob('exams/**/*.txt')])
USERS = {
    'slips': [ROOT / f'autograder/judging/{name}.py' for name in ('rows', 'log_rows')],
    'readings': [ROOT / 'exams/visible/temperature_subscriber.py'],
    'check_your_understanding': [ROOT / 'autograder/submission/cells.py'],
}
"""Other modules that use the causes in a table."""
NAMES = r'WHY\.(of|slip|failed)'


def words_in(module):
    """Return the names of the causes that a module uses, and all of its strings."""
    names, strings = set(), set()
    for node in ast.walk(ast.parse(module.read_text(encoding='utf-8'))):
        key = None
        if isinstance(node, ast.Constant):
            strings.add(node.value)
        elif isinstance(node, ast.Subscript) and ast.unparse(node.value).endswith('WHY'):
            key = node.slice
        elif isinstance(node, ast.Call) and re.fullmatch(NAMES, ast.unparse(node.func)):
            key = node.args[0]
        if isinstance(key, ast.Constant):
            names.add(key.value)
    return names, strings


@pytest.mark.parametrize('table', TABLES, ids=lambda path: path.stem)
def test_table_has_the_causes_of_its_module_and_no_other(table):
    """Without a row for a cause, the check would break as soon as a learner makes the mistake."""
    users = [table.with_suffix('.py'), *USERS.get(table.stem, ())]
    rows = importlib.import_module(_name_of(table)).WHY._rows
    closer = {name for row in rows.values() for name in _words(row, 'closer')}
    names, strings = (set().union(*some) for some in zip(*map(words_in, users)))

    assert names <= set(rows)
    assert set(rows) <= strings | closer


def test_failed_check_has_all_its_sentences():
    for table in TABLES:
        rows = importlib.import_module(_name_of(table)).WHY._rows
        for module in (table.with_suffix('.py'), *USERS.get(table.stem, ())):
            for name in _failed(module):
                assert _words(rows[name], 'expected')
                assert _words(rows[name], 'observed')


def _failed(module):
    """Return the names in each first argument of failed(), which may be a condition."""
    tree = ast.parse(module.read_text(encoding='utf-8'))
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    failed = [node.args[0] for node in calls if ast.unparse(node.func) == 'WHY.failed']
    parts = [part for one in failed for part in ast.walk(one)]
    return [part.value for part in parts if isinstance(part, ast.Constant)]


def _words(row, field):
    return [word for line in row if line.startswith(f'{field}: ') for word in line.split()[1:]]


def _name_of(table):
    return '.'.join(table.with_suffix('').relative_to(ROOT).parts)


def test_row_gives_all_fields_of_a_cause(tmp_path):
    (tmp_path / 'exam.txt').write_text(
        'late\nIt is\n  {how} late.\nRun {TOPIC}.\n'
        'act: reset()\nabout: a {TOPIC}\ncloser: late_too\n'
        'expected: {count} on {TOPIC}\nobserved: nothing\n\n'
        'late|late_too\nIt is {{late}}.\nRun.\n',
        encoding='utf-8',
    )
    causes = Causes(str(tmp_path / 'exam.py'), TOPIC='/map')

    found = causes.of('late', how='very', line=3)
    slip = causes.slip('late_too', list)

    sentences = (found.text, found.try_this)
    assert (found.cause_id, *sentences) == ('late', 'It is very late.', 'Run /map.')
    assert (found.act, found.about, found.line) == ('reset()', ['a', '/map'], 3)
    assert [one.text for one in found.closer] == [slip.text] == ['It is {late}.']
    assert (slip.cause_id, slip.rules) == ('late', (list,))

    failed = causes.failed('late', how='very', count=3, place=1)

    assert (failed.expected, failed.observed, failed.place) == ('3 on /map', 'nothing', 1)
    assert failed.why.text == 'It is very late.'
    assert causes.failed('late', slip, how='very', count=3).why is slip


def test_row_that_is_missing_or_incomplete_is_an_error_of_the_exam(tmp_path):
    table, module = tmp_path / 'exam.txt', str(tmp_path / 'exam.py')
    table.write_text('late\nIt is late.\nRun.\n', encoding='utf-8')
    with pytest.raises(ExamInvalid, match=r"exam\.txt: there is no cause 'early'.*Known: late"):
        Causes(module)['early']

    with pytest.raises(ExamInvalid, match=r"exam\.txt: there is no cause 'early'"):
        Causes(module).failed('early')
    with pytest.raises(ExamInvalid, match=r'exam\.txt, late: add the lines expected: and obs'):
        Causes(module).failed('late')

    table.write_text('late\nIt is late.\n', encoding='utf-8')
    with pytest.raises(ExamInvalid, match=r'exam\.txt, late: expected a sentence and a fix'):
        Causes(module)
