"""A session for the tests of roslab's functions in the test process."""

from contextlib import ExitStack

import pytest
from rclpy.context import Context

from roslab.session import Session
from tests.own_domain import own_domain


class PrivateSession(Session):
    """A session in a separate domain, with a context that nothing else uses."""

    def __init__(self, domain):
        super().__init__()
        self.domain = domain

    def _context(self):
        made = Context()
        made.init(args=[], domain_id=self.domain)
        return made


@pytest.fixture
def session(monkeypatch):
    """Return the session of this process, which shares nothing with other tests."""
    with ExitStack() as until:
        made = PrivateSession(own_domain(until))
        monkeypatch.setattr('roslab.session._session', made)
        yield made
        made.close()
