"""The folder of nbgrader's exchange, and the modes that protect the work in it."""

import os
import stat

import pytest

from environment import doctor
from environment.exchange import exchange_root, protect, SETTING, unprotected


@pytest.fixture
def exchange(tmp_path):
    """Return an exchange with nbgrader's own modes."""
    root = tmp_path / 'an exchange'
    inbound = root / 'course' / 'inbound'
    inbound.mkdir(parents=True)
    root.chmod(0o777)
    inbound.chmod(0o2733)
    return root


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_exchange_is_in_the_course_unless_the_setting_names_another(tmp_path):
    """A relative path in the setting is relative to the course's folder."""
    assert exchange_root(tmp_path, {}) == tmp_path / 'autograder' / '_work' / 'exchange'
    assert exchange_root(tmp_path, {SETTING: '/srv/exchange'}).as_posix() == '/srv/exchange'
    assert exchange_root(tmp_path, {SETTING: 'x'}) == tmp_path / 'x'


def test_protect_sets_the_sticky_bit_and_keeps_the_rest(exchange):
    """With the sticky bit, students can hand in work, and remove only their own."""
    protect(exchange)

    assert mode(exchange) == 0o1777
    assert mode(exchange / 'course' / 'inbound') == 0o3733
    assert unprotected(exchange) == []


def test_protect_leaves_a_missing_exchange_missing(tmp_path):
    """Reading the settings does not create the exchange."""
    protect(tmp_path / 'nothing')

    assert not (tmp_path / 'nothing').exists()


def test_doctor_names_the_folder_and_what_to_type(exchange):
    """The command to type quotes the folder for a shell."""
    finding = doctor.check_exchange(exchange)

    assert finding.state == doctor.WEAK
    assert finding.detail == f'in {exchange}, users can remove the work of others'
    assert os.system(finding.fix) == 0
    assert doctor.check_exchange(exchange).state == doctor.OK
    assert mode(exchange / 'course' / 'inbound') == 0o3733


def test_doctor_accepts_a_course_without_an_exchange(tmp_path):
    assert doctor.check_exchange(tmp_path / 'nothing').state == doctor.OK
