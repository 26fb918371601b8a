"""
Draw secret, reproducible inputs that are the same for the whole class.

A random generator is seeded with HMAC-SHA256(course secret, exam name and purpose).  So a
submission cannot contain the answers, all students get the same inputs, and a run can be repeated
after an appeal.  The secret is created once and stored next to the gradebook; the environment
variable ``COURSE_SECRET`` overrides it.  The first grading of a class stores a fingerprint of the
secret: with a different secret, all programs would run again, with different inputs.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
import hashlib
import hmac
import os
from pathlib import Path
import random
import secrets

from autograder.errors import GraderError
from autograder.files import write_atomically
from autograder.layout import Layout

WATCH_S = 131
"""
Time for which hidden exams watch a node that acts by itself [s].

By then, a counter of one byte that grows twice a second has overflowed.
"""
_other_secret: ContextVar[bytes | None] = ContextVar('_other_secret', default=None)


@lru_cache(maxsize=1)
def course_secret() -> bytes:
    """
    Return the course secret, which is created on first use.

    Only the owner can read its file, which is created atomically: if two graders start at the same
    time, both read the secret of the faster one.

    :raises GraderError: if the secret is empty, or missing although the class was graded
    """
    layout = Layout.here()
    if 'COURSE_SECRET' in os.environ:
        return _not_empty(os.environ['COURSE_SECRET'].encode(), 'COURSE_SECRET', layout)
    file = layout.secret
    if not file.exists():
        if fingerprint_file(layout).exists():
            raise _refusal(layout, f'{file}: the course secret of this class is missing.')
        file.parent.mkdir(parents=True, exist_ok=True)
        draft = file.with_name(f'.course_secret.{secrets.token_hex(8)}')
        draft.touch(mode=0o600)
        draft.write_text(secrets.token_hex(32), encoding='ascii')
        try:
            os.link(draft, file)
        except FileExistsError:
            pass
        finally:
            draft.unlink()
    return _not_empty(file.read_bytes(), str(file), layout)


def _not_empty(secret: bytes, where: str, layout: Layout) -> bytes:
    """Reject an empty secret, with which anyone could compute all hidden inputs."""
    if not secret.strip():
        raise _refusal(layout, f'{where}: expected the course secret, got an empty string.')
    return secret


def fingerprint_file(layout: Layout) -> Path:
    """Return the file with the fingerprint of the secret with which a class was graded."""
    return layout.secret.with_name('secret_fingerprint')


def refuse_other_secret(layout: Layout) -> None:
    """Raise a GraderError if the class was graded with a different course secret."""
    path = fingerprint_file(layout)
    if path.is_file() and path.read_bytes().strip() != _fingerprint(course_secret()):
        where = 'COURSE_SECRET' if 'COURSE_SECRET' in os.environ else layout.secret
        raise _refusal(layout, f'{where}: this class was graded with a different course secret.')


def keep_secret(layout: Layout) -> None:
    """Store the fingerprint of the course secret for a class; refuse a different secret."""
    refuse_other_secret(layout)
    if not fingerprint_file(layout).is_file():
        write_atomically(fingerprint_file(layout), _fingerprint(course_secret()) + b'\n')


def _fingerprint(secret: bytes) -> bytes:
    """Return a digest that identifies a course secret but does not reveal it."""
    return hmac.new(secret, b'fingerprint', hashlib.sha256).hexdigest().encode()


def _refusal(layout: Layout, what: str) -> GraderError:
    """Return the error for an unusable secret, with advice that keeps the inputs of a class."""
    path = fingerprint_file(layout)
    if not path.exists():
        fix = 'set a value, or remove the empty one; the grader then creates a secret.'
    else:
        fix = f'restore {layout.secret} from a backup, or set COURSE_SECRET to the former value'
        stored = layout.secret.read_bytes() if layout.secret.is_file() else b''
        if path.read_bytes().strip() == _fingerprint(stored):
            fix = 'unset COURSE_SECRET'
        fix += f'. To grade everybody again with new inputs, remove {path}. No mark was changed.'
    return GraderError(what, f'Try: {fix}')


def generator(exam: str, purpose: str) -> random.Random:
    """Return a random generator; those for different purposes of an exam are independent."""
    secret = _other_secret.get() or course_secret()
    digest = hmac.new(secret, f'{exam}/{purpose}'.encode(), hashlib.sha256).digest()
    return random.Random(digest)  # noqa: S311 - only the seed must be secret


@contextmanager
def another_secret(secret: str) -> Iterator[None]:
    """Draw inputs from a different secret, for tests of exams and never for grading."""
    token = _other_secret.set(secret.encode())
    try:
        yield
    finally:
        _other_secret.reset(token)
