"""
Write ``docs/coverage.md``: the claims of the course, the cells that teach them and their proofs.

The page combines three sources: the claims in ``points.yaml`` and ``corrections.yaml``, the code
cells of ``solutions/`` that name claims in their metadata (``"covers": ["N1"]``), and tests that
are marked ``@pytest.mark.claim('N1')``.  A claim has one proof: the output of its cells
(``shows``), a test, or, for a correction, the claims that it refers to (``see``).  Nothing is
imported or executed, so this is quick::

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


def claims(*names: str) -> dict[str, dict[str, Any]]:
    """Return the claims of one or both of the two files, by id."""
    found = {}
    for name in names or ('points.yaml', 'corrections.yaml'):
        found.update(yaml.safe_load((HERE / name).read_text(encoding='utf-8')))
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


def problems(taught: Places, tested: Places) -> Iterator[str]:
    """Yield a line for each claim without a cell or without one proof, and each unknown claim."""
    known = claims()
    for claim, entry in known.items():
        sentence = entry.get('claim') or entry['right']
        if claim not in taught:
            yield f'{claim} is taught in no code cell: {sentence}'
        proofs = [how for how in ('shows', 'see') if how in entry]
        proofs += ['a test'] if claim in tested else []
        if len(proofs) != 1:
            yield f'{claim} needs one proof, but has {" and ".join(proofs) or "none"}: {sentence}'
        for see in entry.get('see', ()):
            if see not in known:
                yield f'{claim} refers to {see}, which is not a known claim.'
    for claim in sorted((taught.keys() | tested.keys()) - known.keys()):
        where = [*taught.get(claim, ()), *tested.get(claim, ())]
        yield f'{claim} is not a known claim, but {", ".join(where)} names it.'


def _proof(claim: str, entry: Mapping[str, Any], tested: Places) -> str:
    """Return what proves a claim: output, tests, or the claims that a correction refers to."""
    if 'shows' in entry:
        return 'output'
    return ', '.join(entry['see']) if 'see' in entry else _listed(tested.get(claim))


def table(taught: Places, tested: Places) -> str:
    """Return the page."""
    points, corrections = claims('points.yaml'), claims('corrections.yaml')
    shown = sum('shows' in entry for entry in points.values())
    lines = [
        '# Claims of the course, where they are taught, and what proves them',
        '',
        'Written by `python -m tests.claims.coverage`; `make check` compares. A claim is taught '
        'in code cells (lesson and cell id). *Output*: these cells prove it in front of the '
        'learner; `tests/notebooks/test_lessons.py` executes the lessons with real ROS 2 and '
        'compares the output with the pattern in `tests/claims/`. Otherwise, a test under '
        '`tests/` proves the claim; the proof of a correction can be that of other claims.',
        '',
        f'{len(points)} claims, {shown} of them proven by output; {len(corrections)} corrections '
        'of common misconceptions.',
    ]
    for letter, title in GROUPS.items():
        lines += ['', f'## {title}', '', '| | claim | taught in | proven by |']
        lines += ['|---|---|---|---|']
        lines += [
            f'| {claim} | {_plain(point["claim"])} | {_listed(taught.get(claim))} '
            f'| {_proof(claim, point, tested)} |'
            for claim, point in points.items()
            if claim[0] == letter
        ]
    lines += ['', '## Misconceptions', '']
    lines += ['| | misconception | correction | taught in | proven by |', '|---|---|---|---|---|']
    lines += [
        f'| {claim} | {_plain(entry["wrong"])} | {_plain(entry["right"])} '
        f'| {_listed(taught.get(claim))} | {_proof(claim, entry, tested)} |'
        for claim, entry in corrections.items()
    ]
    return '\n'.join(lines) + '\n'


def _plain(text: str) -> str:
    return text.replace('|', r'\|').replace('_', r'\_').replace('*', r'\*')


def _listed(places: Sequence[str] | None) -> str:
    return ', '.join(f'`{place}`' for place in places or ())


def main(arguments: Sequence[str]) -> int:
    """Write the table, or compare it."""
    taught, tested = cells(), tests()
    text = table(taught, tested)
    found = list(problems(taught, tested))
    if '--check' in arguments:
        if not TABLE.is_file() or TABLE.read_text(encoding='utf-8') != text:
            found.append(f'{TABLE.relative_to(ROOT)} is out of date. Try: make coverage')
        print('\n'.join(found) or 'Every claim of the course is taught in a cell and proven.')
        return 1 if found else 0
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(text, encoding='utf-8')
    print('\n'.join([*found, f'{TABLE.relative_to(ROOT)} is written.']))
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
