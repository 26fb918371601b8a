"""
Draw secret, reproducible inputs that are the same for the whole class.

A random generator is seeded with HMAC-SHA256(course secret, exam name and purpose).  So a
submission cannot contain the answers, all students get the same inputs, and a run can be repeated
after an appeal.  The secret is created once and stored next to the gradebook; the environment
variable ``COURSE_SECRET`` overrides it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
import hashlib
import hmac
import os
import random
import secrets

from autograder.errors import GraderError
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

    :raises GraderError: if the secret is empty
    """
    if 'COURSE_SECRET' in os.environ:
        return _not_empty(os.environ['COURSE_SECRET'].encode(), 'COURSE_SECRET')
    file = Layout.here().secret
    if not file.exists():
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
    return _not_empty(file.read_bytes(), str(file))


def _not_empty(secret: bytes, where: str) -> bytes:
    """Reject an empty secret, with which anyone could compute all hidden inputs."""
    if not secret.strip():
        raise GraderError(
            f'{where}: expected the course secret, got an empty string.',
            'Try: set a value, or remove the empty one; the grader then creates a secret.',
        )
    return secret


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
