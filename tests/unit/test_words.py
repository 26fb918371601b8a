"""The text files of exams have the words of each cause that the code names, and of no other."""

from __future__ import annotations

import ast
import importlib

import pytest

from autograder.exam.words import Causes
from autograder.layout import Layout

GRADER = Layout.here().root / 'autograder'
TABLES = sorted(path for path in GRADER.glob('exam*/**/*.txt') if path.parent.name != 'hidden')


def names_in(module):
    """Return the names of causes that a module takes from its own table."""
    found = set()
    for node in ast.walk(ast.parse(module.read_text(encoding='utf-8'))):
        if isinstance(node, ast.Subscript) and ast.unparse(node.value) in ('WHY', 'monitor.WHY'):
            key = node.slice
        elif isinstance(node, ast.Call) and node.args:
            if ast.unparse(node.func) not in ('WHY.of', 'WHY.slip', 'slip'):
                continue
            key = node.args[0]
        else:
            continue
        names = [key.body, key.orelse] if isinstance(key, ast.IfExp) else [key]
        found.update(one.value for one in names if isinstance(one, ast.Constant))
    return found


@pytest.mark.parametrize('table', TABLES, ids=lambda path: path.stem)
def test_table_has_what_its_module_names(table):
    """A name without a row would break a check when a learner makes the mistake."""
    users = [table.with_suffix('.py')]
    users += [table.parent / 'visible/temperature_subscriber.py'] * (table.stem == 'readings')
    name = '.'.join(table.with_suffix('').relative_to(GRADER.parent).parts)
    causes = importlib.import_module(name).WHY
    closer = {
        one
        for row in causes._rows.values()
        for line in row
        if line.startswith('closer: ')
        for one in line.split()[1:]
    }

    assert set().union(*map(names_in, users)) | closer == set(causes._rows)


def test_row_gives_all_fields_of_a_cause(tmp_path):
    """Constants are put in first, and the rest where the cause is given."""
    (tmp_path / 'exam.txt').write_text(
        'late\nIt is\n  {how} late.\nRun {TOPIC}.\n'
        'act: reset()\nabout: a {TOPIC}\ncloser: late_too\n\n'
        'late|late_too\nIt is {{late}}.\nRun.\n',
        encoding='utf-8',
    )
    causes = Causes(str(tmp_path / 'exam.py'), TOPIC='/map')

    found = causes.of('late', how='very', line=3)
    slip = causes.slip('late_too', list)

    assert (found.cause_id, found.text, found.try_this) == (
        'late',
        'It is very late.',
        'Run /map.',
    )
    assert (found.act, found.about, found.line) == ('reset()', ['a', '/map'], 3)
    assert [one.text for one in found.closer] == [slip.text] == ['It is {late}.']
    assert (slip.cause_id, slip.rules) == ('late', (list,))
