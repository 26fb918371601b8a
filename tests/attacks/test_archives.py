"""
Malicious archives and folders are refused with an error, or do no harm.

Each archive of :mod:`tests.attacks.archives` is next to a file that it would overwrite or read.
After each, an honest archive is accepted.
"""

import io
import os
from pathlib import Path
import socket
import stat
import zipfile

import pytest

from autograder.submission import package
from autograder.submission.package import read_upload
from autograder.submission.reading import UnusableUploadError
from tests.attacks.archives import KEPT, pack, PACKAGE, REFUSED
from tests.attacks.corpus import CANARY

pytestmark = pytest.mark.attacks


@pytest.fixture
def outside(tmp_path) -> Path:
    """Return a folder next to the archive, with a file that must not be read or changed."""
    folder = tmp_path / 'outside'
    folder.mkdir()
    (folder / 'gradebook.txt').write_text(CANARY, encoding='utf-8')
    return folder


def everything(folder: Path) -> list[tuple[str, int]]:
    """Return all files below a folder with their sizes, without the archive."""
    found = [(str(path), path.lstat().st_size) for path in folder.rglob('*')]
    return sorted(one for one in found if not one[0].endswith('.zip'))


@pytest.mark.parametrize('trick', REFUSED, ids=lambda trick: trick.__name__)
def test_a_hostile_archive_is_refused_in_words_and_writes_nothing(trick, tmp_path, outside):
    """The error is one printable line; an honest archive after it is accepted."""
    before = everything(tmp_path)

    with pytest.raises(UnusableUploadError, match=REFUSED[trick]) as refusal:
        read_upload(trick(tmp_path))

    said = str(refusal.value)
    assert said.isprintable()
    assert CANARY not in said
    assert len(said) < 600
    assert everything(tmp_path) == before
    assert read_upload(pack(tmp_path)) == KEPT


def test_an_archive_in_an_archive_is_not_opened(tmp_path, outside):
    """The inner archive may be a bomb, or contain paths that lead outside."""
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, 'w') as archive:
        archive.writestr('../outside/gradebook.txt', 'mine')

    assert read_upload(pack(tmp_path, ('my_pkg/more.zip', inner.getvalue()))) == KEPT


def test_a_name_that_is_not_utf_8_is_read_as_some_letters(tmp_path):
    """Old programs write such names; the name still refers to a file in the archive."""
    path = pack(tmp_path, ('my_pkg/my_pkg/gru_.py', 'x = 1'))
    path.write_bytes(path.read_bytes().replace(b'gru_', b'gr\xfc_'))

    found = read_upload(path)

    assert sorted(found.values()) == ['<package/>', 'print(1)', 'x = 1']
    assert all(name.isprintable() for name in found)


SPECIAL = {
    'secret': lambda file, outside: file.symlink_to(outside / 'gradebook.txt'),
    'door': lambda file, outside: file.symlink_to(outside),
    'round': lambda file, outside: file.symlink_to(file.parent),
    'pipe': lambda file, outside: os.mkfifo(file),
    'socket': lambda file, outside: _bind(file),
    'device': lambda file, outside: _device(file),
}


def _bind(file):
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(file))


def _device(file):
    if os.geteuid() != 0:
        pytest.skip('only root can create a device')
    os.mknod(file, stat.S_IFCHR | 0o666, os.makedev(1, 5))


@pytest.mark.parametrize('make', SPECIAL.values(), ids=SPECIAL)
def test_a_folder_with_a_special_file_is_refused_like_a_zip(tmp_path, outside, make):
    """The reader follows no link, waits for no pipe, and opens no device or socket."""
    folder = tmp_path / 'my_pkg'
    (folder / 'my_pkg').mkdir(parents=True)
    for name, text in PACKAGE:
        (tmp_path / name).write_text(text, encoding='utf-8')
    make(folder / 'talker.py', outside)

    with pytest.raises(UnusableUploadError, match='a link or a special file'):
        read_upload(folder)


def test_a_folder_with_a_name_that_is_no_text_is_refused(tmp_path):
    """Such a name cannot be printed."""
    for name, text in PACKAGE:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    Path(os.fsdecode(os.fsencode(tmp_path / 'my_pkg') + b'/\xff\xfe.py')).write_text('x = 1')

    with pytest.raises(UnusableUploadError, match='unprintable characters') as refusal:
        read_upload(tmp_path / 'my_pkg')

    assert str(refusal.value).isprintable()


def test_the_limits_are_far_above_an_honest_package():
    """A package of the course has eight small files."""
    assert package.MOST_FILES >= 100
    assert package.BOUNDS.file_bytes >= 1 << 20
