"""No page, message, Python file or lesson contains a word that docs/style.md rejects."""

import io
import json
from pathlib import Path
import re
import subprocess
import tokenize

import pytest

ROOT = Path(__file__).resolve().parents[2]
STYLE = ROOT / 'docs' / 'style.md'
WORDS = re.findall(
    r'^\| ([A-Za-z ]+) \|', STYLE.read_text(encoding='utf-8').partition('| not | but |')[2], re.M
)
# Capitals in the table matter: "cannot tell whether" is good English.
ANY_CASE = [word if word[0].isupper() else f'(?i:{word})' for word in WORDS]
PHRASES = re.compile(rf'\b({"|".join(ANY_CASE)})\b'.replace(' ', r'\s+'))
# The samples imitate students, CHANGELOG.md is history, and notebooks/ and the tables are
# generated.
LEFT_OUT = re.compile(
    r'tests/(submissions|attacks/\w+)/|notebooks/|CHANGELOG\.md|docs/(style|agreement|attacks|causes'
    r'|coverage|mutants)\.md|tests/unit/test_style'
)
CODE = {tokenize.OP, tokenize.NAME, tokenize.NUMBER}


def prose_of(path: Path) -> str:
    """Return the prose in a file: a whole page, or the strings and comments of Python code."""
    text = path.read_text(encoding='utf-8')
    if path.suffix == '.ipynb':
        cells = json.loads(text)['cells']
        return '\n'.join(''.join(one['source']) for one in cells if one['cell_type'] == 'markdown')
    if path.suffix == '.py':
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        return '\n'.join(token.string.strip('# ') for token in tokens if token.type not in CODE)
    return text


@pytest.mark.skipif(not (ROOT / '.git').exists(), reason='asks git which files are tracked')
def test_the_words_that_the_style_keeps_out_are_nowhere():
    listed = ['git', 'ls-files', '*.md', '*.py', 'autograder/*.txt', 'solutions/*.ipynb']
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    found = {
        f'{name}: {" ".join(match[0].split())}'
        for name in names.splitlines()
        if not LEFT_OUT.match(name) and (ROOT / name).is_file()
        for match in PHRASES.finditer(prose_of(ROOT / name))
    }

    assert len(WORDS) > 9
    assert sorted(found) == []
