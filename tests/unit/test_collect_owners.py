"""nbgrader's exchange: work is taken from the student who owns it, and from no other user."""

import os
import pwd

from collect_sources import (
    configure,
    EXCHANGE,
    GOOD,
    laid,
    packed,
    taken,
    TALK,
)
import pytest

from autograder import __main__ as command
from autograder.collect.deliveries import LEFT, TAKEN
from autograder.collect.owners import owner_doubt, user_name
from autograder.commands import OK
from autograder.errors import GraderError
from autograder.submission.reading import read_file

ME = pwd.getpwuid(os.geteuid()).pw_name
UNKNOWN_UID = 4_000_000_000


@pytest.fixture
def hand_in(gather):
    """Return a function that collects, from an exchange, work of the user who runs the tests."""

    def collected(*students):
        place = f'inbound/{{}}+{TALK}+2026-03-01 12:00:00 UTC+q3rYx_-a/talk.ipynb'
        return gather({place.format(one): GOOD for one in students}, trust_names=False)

    return collected


def test_work_that_the_student_owns_is_taken(hand_in):
    (row,) = hand_in(ME)

    assert (row.student, row.done) == (ME, TAKEN)


def test_work_of_another_user_is_refused_with_both_names(hand_in, layout):
    """Work that another user owns is refused, because anyone can choose the folder's name."""
    (row,) = hand_in('ann')

    assert row.done == LEFT
    assert row.notes[0] == (
        f"handed in as 'ann', but owned by '{ME}'; if you copied it there yourself, use "
        '--trust-names (docs/exchange.md)'
    )
    assert taken(layout) == {}


def test_zip_of_an_exchange_is_refused_as_it_names_no_owner(gather):
    rows = gather(EXCHANGE, packed, trust_names=False)

    assert {row.done for row in rows} == {LEFT}
    assert 'a zip does not record the owner' in rows[0].notes[0]


def test_recorded_owner_is_accepted(hand_in, layout):
    """A recorded owner is accepted where student ids differ from user names."""
    owners = f"c.ExchangeCollect.owners = {{'1001': '{ME}', '{ME}': 'somebody'}}\n"
    configure(layout.root, 'sqlite:////nowhere', owners)

    rows = hand_in('1001', ME)

    assert [(row.student, row.done) for row in rows] == [('1001', TAKEN), (ME, LEFT)]


@pytest.mark.parametrize(
    ('setting', 'options'),
    [('c.ExchangeCollect.check_owner = False\n', []), ('', ['--trust-names'])],
)
def test_names_are_trusted_when_the_instructor_says_so(setting, options, tmp_path, here):
    configure(here.root, 'sqlite:////nowhere', setting)
    name = f'ann+{TALK}+2026-03-01 12:00:00 UTC/talk.ipynb'
    assert command.main(['collect', str(laid(tmp_path / 'inbound', {name: GOOD})), *options]) == OK
    assert f'ann/{TALK}/talk.ipynb' in taken(here)


def test_owners_that_are_no_dictionary_are_one_sentence(hand_in, layout):
    configure(layout.root, 'sqlite:////nowhere', "c.ExchangeCollect.owners = 'ann'\n")

    with pytest.raises(GraderError, match=r'owners is not a dictionary. Try: c.ExchangeCollect'):
        hand_in(ME)


def test_one_file_of_another_user_is_enough_to_refuse():
    """One file of another user is enough, because every user can write to nbgrader's folders."""
    both = {os.geteuid(), UNKNOWN_UID}

    assert owner_doubt(ME, both, {}) == f"handed in as '{ME}', but owned by 'uid {UNKNOWN_UID}'"
    assert owner_doubt(ME, {os.geteuid()}, {}) == ''
    assert user_name(os.geteuid()) == ME


def test_file_that_another_user_put_in_its_place_is_not_read(tmp_path):
    """The owner is that of the opened file, even if the file was replaced after the listing."""
    path = tmp_path / 'talk.ipynb'
    path.write_bytes(GOOD)

    data, problems = read_file(path, 'talk.ipynb', UNKNOWN_UID)

    assert data is None
    assert problems[0].got == 'a file that another user put in its place'
    assert read_file(path, 'talk.ipynb', os.geteuid()) == (GOOD, ())
