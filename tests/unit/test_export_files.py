"""Exported files are written atomically and replace nothing unless forced."""

import os
from unittest.mock import Mock

from hypothesis import given, settings, strategies
import pytest

from autograder.errors import GraderError
from autograder.files import LONGEST_NAME, refuse_existing, safe_name, write_atomically


def test_a_file_is_written_with_its_folder_and_nothing_else(tmp_path):
    write_atomically(tmp_path / 'new' / 'marks.csv', b'data', mode=0o600)

    assert (tmp_path / 'new' / 'marks.csv').read_bytes() == b'data'
    assert os.listdir(tmp_path / 'new') == ['marks.csv']
    assert (tmp_path / 'new' / 'marks.csv').stat().st_mode & 0o777 == 0o600


def test_a_file_that_is_there_stays_unless_forced(tmp_path):
    path = tmp_path / 'marks.csv'
    path.write_bytes(b'old')

    with pytest.raises(GraderError, match=r'already exists\. Try: --force'):
        refuse_existing([path], force=False)
    refuse_existing([path], force=True)
    write_atomically(path, b'new')
    assert path.read_bytes() == b'new'


def test_a_failed_write_leaves_the_old_file_whole(tmp_path, monkeypatch):
    path = tmp_path / 'marks.csv'
    path.write_bytes(b'old')

    monkeypatch.setattr(os, 'fsync', Mock(side_effect=OSError(28, 'No space left on device')))

    with pytest.raises(OSError, match='No space'):
        write_atomically(path, b'new')
    assert path.read_bytes() == b'old'
    assert os.listdir(tmp_path) == ['marks.csv']


def test_a_file_that_need_not_last_does_not_wait_for_the_disk(tmp_path, monkeypatch):
    monkeypatch.setattr(os, 'fsync', None)

    write_atomically(tmp_path / 'page.html', b'new', lasting=False)

    assert (tmp_path / 'page.html').read_bytes() == b'new'
    assert os.listdir(tmp_path) == ['page.html']


def test_a_link_is_something_that_is_there_and_a_folder_is_not_replaced(tmp_path):
    (tmp_path / 'marks.csv').symlink_to('nowhere')

    with pytest.raises(GraderError, match='already exists'):
        refuse_existing([tmp_path / 'marks.csv'], force=False)
    with pytest.raises(GraderError, match='this is a folder'):
        refuse_existing([tmp_path], force=True)


@pytest.mark.parametrize('letter', ['x', 'ü', 'Щ', '漢', '\N{GRINNING FACE}', '~', '.'])
@pytest.mark.parametrize('count', [1, 42, 100, 1000])
def test_a_long_id_is_a_file_name_all_the_same(tmp_path, letter, count):
    names = [safe_name(letter * count + end) for end in ('', 'a', 'b')]

    assert len(set(names)) == 3
    for name in names:
        assert len(name.encode()) <= LONGEST_NAME
        write_atomically(tmp_path / f'{name}.html', b'x')


def test_short_names_stay_as_they_are_and_signs_that_stand_for_others_do_not():
    assert safe_name('x' * LONGEST_NAME) == 'x' * LONGEST_NAME
    assert safe_name('ü b') == '~C3~BC~20b'
    for one, two in (('a b', 'a~20b'), ('', '~'), ('Щ' * 42, safe_name('Щ' * 42))):
        assert safe_name(one) != safe_name(two)


@pytest.mark.slow
@settings(deadline=None, max_examples=40)
@given(strategies.text(max_size=20), strategies.text(max_size=20))
def test_names_of_files_are_safe_and_as_different_as_the_ids(one, two):
    try:
        names = safe_name(one), safe_name(two)
    except UnicodeEncodeError:
        return  # a lone surrogate is not valid in a file name; such ids are never graded

    for name in names:
        assert name
        assert '/' not in name
        assert not name.startswith('.')
    assert (names[0] == names[1]) == (one == two)
