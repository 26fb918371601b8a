"""
Check that no string makes a regular expression of the grader slow.

Students choose the strings that the grader searches in its own process.  The tests take each
pattern that is a single string in a call of ``re`` or in the tables of mistakes, and try it on
strings in which a search starts again at each letter.
"""

import ast
from collections.abc import Iterator
from pathlib import Path
import re
import time

import pytest

from autograder.judging.causes.text_table import rows_of

GRADER = Path(__file__).parents[2] / 'autograder'
IN_THE_SANDBOX = ('inside/', 'probe/', '_work/')
METHODS = {'search', 'match', 'fullmatch', 'findall', 'finditer', 'sub', 'subn', 'split'}
PIECES = (*' \n\ta_0(["\'=./\\{<;:', 'a ', 'a.', '- ', 'a,', ';\n', '" ')
LENGTH = 1000
NOTHING_S = 0.005  # a search in one pass takes a tenth of this time
LONGER = 4
QUADRATIC = 9.0  # ratio of times for a string four times as long: 4 in one pass, otherwise 16


def written_patterns() -> Iterator[tuple[str, re.Pattern[str], str]]:
    """Yield the place of each pattern, the pattern, and the method that uses it."""
    for path in sorted(GRADER.rglob('*.py')):
        place = path.relative_to(GRADER).as_posix()
        if not place.startswith(IN_THE_SANDBOX):
            tree = ast.parse(path.read_text(encoding='utf-8'))
            for call, pattern, method in patterns_in(tree):
                yield f'{place}:{call.lineno}', pattern, method
    for name in ('by_exception.txt', 'of_builds.txt', 'of_python_builds.txt'):
        for row in rows_of(name):
            yield f'{name} {row.cause_id}', re.compile(row.when), 'search'


def patterns_in(tree: ast.AST) -> Iterator[tuple[ast.Call, re.Pattern[str], str]]:
    """Yield the calls of ``re`` whose pattern is a string literal."""
    used: dict[str, set[str]] = {}
    named: dict[int, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            used.setdefault(node.value.id, set()).add(node.attr)
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            named[id(node.value)] = node.targets[0].id
    for node in ast.walk(tree):
        match node:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id='re'), attr=method),
                args=[ast.Constant(value=str(text)), *_],
            ) if method in METHODS | {'compile'}:
                methods = {method}
                if method == 'compile':
                    methods = used.get(named.get(id(node), ''), set()) & METHODS or {'search'}
                anchored = methods <= {'match', 'fullmatch'}
                yield node, re.compile(text, flags(node)), 'match' if anchored else 'search'


def flags(call: ast.Call) -> int:
    """Return the flags that a call names, as in ``re.MULTILINE``."""
    found = 0
    for node in ast.walk(call):
        match node:
            case ast.Attribute(value=ast.Name(id='re'), attr=name) if name.isupper():
                found |= getattr(re, name)
    return found


def hostile(pattern: str, length: int) -> Iterator[str]:
    """Yield strings that repeat one piece, alone and after words of the pattern."""
    plain = re.sub(r'\\[a-zA-Z]|\?P<\w+>', ' ', pattern)
    words = list(dict.fromkeys(re.findall('[A-Za-z_]{2,}', plain)))[:6]
    heads = ('', 'def main', 'x = ', '"', '(', 'File "/', *words)
    heads += tuple(word + more for word in words for more in ('(', ' = '))
    for piece in PIECES:
        for head in heads:
            yield head + piece * (length // len(piece))
    for word in words:
        for more in ('', '(', ' ', '\n', 'a,', '"'):
            yield (word + more) * (length // len(word + more))


def seconds_of(pattern: re.Pattern[str], method: str, text: str) -> float:
    """Return the lowest processor time of some searches."""
    times = []
    for _ in range(7):
        began = time.process_time()
        getattr(pattern, method)(text)
        times.append(time.process_time() - began)
        if times[-1] < NOTHING_S:
            break
    return min(times)


def slow_text(pattern: re.Pattern[str], method: str) -> str | None:
    """Return a string for which the time grows faster than its length."""
    pairs = zip(hostile(pattern.pattern, LENGTH), hostile(pattern.pattern, LONGER * LENGTH))
    for text, longer in pairs:
        seconds = seconds_of(pattern, method, longer)
        if seconds > NOTHING_S and seconds > QUADRATIC * seconds_of(pattern, method, text):
            return text
    return None


@pytest.mark.slow
def test_every_pattern_is_done_in_one_pass():
    slow = {
        place: (pattern.pattern, text[:30])
        for place, pattern, method in written_patterns()
        if (text := slow_text(pattern, method)) is not None
    }
    assert slow == {}


@pytest.mark.parametrize(
    'code',
    [
        r"re.search(r'^\s*a\s*=', text, re.MULTILINE)",
        r"FOUND = re.compile(r'\w+Error: ')" + '\nFOUND.search(text)',
        r"re.sub(r'([;\n][\"\s]*)=', '', text)",
    ],
)
def test_the_search_finds_what_it_is_for(code):
    """The test finds the patterns that once kept the grader busy."""
    ((_, pattern, method),) = patterns_in(ast.parse(code))
    assert slow_text(pattern, method) is not None


def test_a_pattern_that_is_matched_at_the_beginning_only_is_no_search():
    ((_, pattern, method),) = patterns_in(
        ast.parse(r"WORD = re.compile(r'\w+Error: ')" + '\nWORD.match(text)')
    )
    assert method == 'match'
    assert slow_text(pattern, method) is None
