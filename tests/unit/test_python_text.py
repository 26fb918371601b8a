"""Several threads can parse learners' Python at once."""

import ast
from concurrent.futures import ThreadPoolExecutor
import gc
import time

import pytest

from autograder.submission.code.program import NotPythonError, parsed

WIDE = '[' + '[1, -2, a.b.c], ' * 300 + ']'
DEEP = '-' * 900 + '1'


def let_others_run(*_):
    """Release the interpreter lock while a tree is being built."""
    time.sleep(0.0005)


@pytest.fixture
def crowded():
    """Switch threads after every few new objects."""
    before = gc.get_threshold()
    gc.callbacks.append(let_others_run)
    gc.set_threshold(50)
    yield
    gc.set_threshold(*before)
    gc.callbacks.remove(let_others_run)


def kind_of(text):
    """Return the type of a parsed string, or 'none'."""
    try:
        return type(parsed(text, 'eval')).__name__
    except NotPythonError:
        return 'none'


@pytest.mark.slow
@pytest.mark.usefixtures('crowded')
@pytest.mark.slow
def test_threads_do_not_disturb_one_another():
    """Python 3.11.2 raises a SystemError if two threads parse at once."""
    texts = [WIDE, DEEP] * 20

    with ThreadPoolExecutor(4) as pool:
        kinds = list(pool.map(kind_of, texts))

    assert set(kinds[::2]) == {'Expression'}
    assert len(set(kinds[1::2])) == 1  # Python limits the depth of a tree


@pytest.mark.parametrize('text', ['x = (', 'a\0b', '(' * 5000, 'return' * 3 + '!'])
def test_what_is_no_python_says_so(text):
    with pytest.raises(NotPythonError):
        parsed(text)


def test_odd_escapes_are_no_warning(recwarn):
    assert isinstance(parsed(r"x = '\d'"), ast.Module)
    assert not recwarn.list
