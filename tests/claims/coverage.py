"""
Write ``docs/coverage.md``: the claims of the course, the cells that teach them and their tests.

The page combines three sources: the claims in ``points.yaml`` and ``corrections.yaml``, the code
cells of ``solutions/`` that name claims in their metadata (``"covers": ["N1"]``), and tests that
are marked ``@pytest.mark.claim('N1')``.  Nothing is imported or executed, so this is quick::

    python -m tests.claims.coverage            write the table
    python -m tests.claims.coverage --check    report what is missing or out of date
"""

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
import json
from pathlib import Path
import sys
from typing import Any

import yaml

from autograder.layout import lesson_files

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
TABLE = ROOT / 'docs' / 'coverage.md'
GROUPS = {
    'N': 'The node and the graph',
    'E': 'The life of a node',
    'X': 'Executors, timers and callbacks',
    'J': 'rclpy in Jupyter',
    'T': 'Topics and discovery',
    'M': 'Messages',
    'Q': 'Quality of service',
    'L': 'Managed nodes',
    'P': 'Logging, parameters, testing',
}
Places = Mapping[str, Sequence[str]]


def claims(name: str) -> dict[str, dict[str, Any]]:
    """Return the claims of one of the two files, by id."""
    found = yaml.safe_load((HERE / name).read_text(encoding='utf-8'))
    assert isinstance(found, dict)
    return found


def cells() -> dict[str, list[str]]:
    """Return the code cells that teach each claim, as ``lesson#cell-id``; text does not count."""
    found = defaultdict(list)
    for path in lesson_files(ROOT / 'solutions'):
        for cell in json.loads(path.read_text(encoding='utf-8'))['cells']:
            if cell['cell_type'] == 'code':
                for claim in cell['metadata'].get('covers', ()):
                    found[claim].append(f'{path.parent.name}#{cell["id"]}')
    return found


def tests() -> dict[str, list[str]]:
    """Return the tests that assert each claim, as ``file::function``."""
    found = defaultdict(list)
    for path in sorted((ROOT / 'tests').rglob('test_*.py')):
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                for claim in _marks(node):
                    found[claim].append(f'{path.relative_to(ROOT / "tests")}::{node.name}')
    return found


def _marks(test: ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[str]:
    for mark in test.decorator_list:
        if isinstance(mark, ast.Call) and ast.unparse(mark.func).endswith('claim'):
            yield from (word.value for word in mark.args if isinstance(word, ast.Constant))


def problems(taught: Places, proven: Places) -> Iterator[str]:
    """Yield a line for each claim without a cell or a test, and for each unknown claim."""
    known = {**claims('points.yaml'), **claims('corrections.yaml')}
    for claim, entry in known.items():
        sentence = entry.get('claim') or entry['right']
        if claim not in taught:
            yield f'{claim} is taught in no code cell: {sentence}'
        if not _proof(claim, entry, proven):
            yield f'{claim} is asserted by no test: {sentence}'
    for claim in sorted((taught.keys() | proven.keys()) - known.keys()):
        where = [*taught.get(claim, ()), *proven.get(claim, ())]
        yield f'{claim} is not a known claim, but {", ".join(where)} names it.'


def _proof(claim: str, entry: Mapping[str, Any], proven: Places) -> list[str]:
    """Return the tests of a claim, or those of the claims that a correction refers to."""
    own = proven.get(claim)
    return [*own] if own else [one for see in entry.get('see', ()) for one in proven.get(see, ())]


def table(taught: Places, proven: Places) -> str:
    """Return the page."""
    points, corrections = claims('points.yaml'), claims('corrections.yaml')
    lines = [
        '# Claims of the course, where they are taught, and their tests',
        '',
        'Written by `python -m tests.claims.coverage`; `make check` compares. A claim is taught '
        'in a code cell (lesson and cell id), and proven by a test under `tests/` that runs real '
        'ROS 2.',
        '',
        f'{len(points)} claims; {len(corrections)} corrections of common misconceptions.',
    ]
    for letter, title in GROUPS.items():
        lines += ['', f'## {title}', '', '| | claim | taught in | proven by |']
        lines += ['|---|---|---|---|']
        lines += [
            f'| {claim} | {_plain(point["claim"])} | {_listed(taught.get(claim))} '
            f'| {_listed(_proof(claim, point, proven))} |'
            for claim, point in points.items()
            if claim[0] == letter
        ]
    lines += ['', '## Misconceptions', '']
    lines += ['| | misconception | correction | taught in | proven by |', '|---|---|---|---|---|']
    lines += [
        f'| {claim} | {_plain(entry["wrong"])} | {_plain(entry["right"])} '
        f'| {_listed(taught.get(claim))} | {_listed(_proof(claim, entry, proven))} |'
        for claim, entry in corrections.items()
    ]
    return '\n'.join(lines) + '\n'


def _plain(text: str) -> str:
    return text.replace('|', r'\|').replace('_', r'\_').replace('*', r'\*')


def _listed(places: Sequence[str] | None) -> str:
    return ', '.join(f'`{place}`' for place in places or ())


def main(arguments: Sequence[str]) -> int:
    """Write the table, or compare it."""
    taught, proven = cells(), tests()
    text = table(taught, proven)
    found = list(problems(taught, proven))
    if '--check' in arguments:
        if not TABLE.is_file() or TABLE.read_text(encoding='utf-8') != text:
            found.append(f'{TABLE.relative_to(ROOT)} is out of date. Try: make coverage')
        print('\n'.join(found) or 'Every claim of the course is taught in a cell, and proven.')
        return 1 if found else 0
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(text, encoding='utf-8')
    print('\n'.join([*found, f'{TABLE.relative_to(ROOT)} is written.']))
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
