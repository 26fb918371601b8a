"""A session for the tests of roslab's functions in the test process."""

from contextlib import ExitStack

import pytest
from rclpy.context import Context

from roslab.session import Session
from tests.own_domain import own_domain


@pytest.fixture
def session(monkeypatch):
    """Return the session of this process, which shares nothing with other tests."""
    with ExitStack() as until:
        made = Session(Context(), domain_id=own_domain(until))
        monkeypatch.setattr('roslab.session._session', made)
        yield made
        made.close()
