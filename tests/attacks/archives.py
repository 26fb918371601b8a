"""
Create malicious zip files, each with one function.

The docstring of a function says what its zip tries; :data:`REFUSED` has the error messages.
:mod:`autograder.submission.package` defines what a zip may contain.
"""

from collections.abc import Callable
from pathlib import Path
import stat
import struct
import warnings
import zipfile

TALKER = ('my_pkg/my_pkg/talker.py', 'print(1)')
PACKAGE = (('my_pkg/package.xml', '<package/>'), TALKER)
KEPT = {'package.xml': '<package/>', 'my_pkg/talker.py': 'print(1)'}


def pack(folder: Path, *more: tuple[str | zipfile.ZipInfo, str | bytes]) -> Path:
    """Write a zip with a valid package and further entries: name or ZipInfo, and content."""
    path = folder / 'handed_in.zip'
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, content in (*PACKAGE, *more):
            archive.writestr(name, content)
    return path


def entry(name: str, kind: int = stat.S_IFREG) -> zipfile.ZipInfo:
    """Return a zip entry for a type of file, such as a link."""
    info = zipfile.ZipInfo(name)
    info.external_attr = (kind | 0o666) << 16
    return info


def set_bytes(path: Path, mark: bytes, offset: int, value: bytes) -> Path:
    """Overwrite bytes at an offset from the last mark, to make the zip invalid."""
    data = bytearray(path.read_bytes())
    at = data.rindex(mark) + offset
    data[at : at + len(value)] = value
    path.write_bytes(data)
    return path


def climbs_out(folder: Path) -> Path:
    """Name a file above the package's folder."""
    return pack(folder, ('../outside/gradebook.txt', 'mine'))


def climbs_out_later(folder: Path) -> Path:
    """Name a file above the folder with a path that first descends."""
    return pack(folder, ('my_pkg/a/../../../outside/gradebook.txt', 'mine'))


def is_absolute(folder: Path) -> Path:
    """Name a file by its absolute path."""
    return pack(folder, (f'{folder}/outside/gradebook.txt', 'mine'))


def links_out(folder: Path) -> Path:
    """Contain a link to a file outside, under the name of a module."""
    link = entry('my_pkg/my_pkg/secret.py', stat.S_IFLNK)
    return pack(folder, (link, str(folder / 'outside' / 'gradebook.txt')))


def writes_through_a_link(folder: Path) -> Path:
    """Contain a link to a folder, and then a file below the link."""
    link = entry('my_pkg/door', stat.S_IFLNK)
    return pack(folder, (link, str(folder / 'outside')), ('my_pkg/door/gradebook.txt', 'mine'))


def holds_a_pipe(folder: Path) -> Path:
    """Contain a pipe, from which reading would never end."""
    return pack(folder, (entry('my_pkg/my_pkg/pipe.py', stat.S_IFIFO), ''))


def holds_a_device(folder: Path) -> Path:
    """Contain a device under the name of a module."""
    return pack(folder, (entry('my_pkg/my_pkg/zero.py', stat.S_IFCHR), ''))


def is_encrypted(folder: Path) -> Path:
    """Declare that a file is encrypted."""
    path = pack(folder, ('my_pkg/my_pkg/locked.py', 'x = 1'))
    return set_bytes(path, b'PK\x01\x02', 8, struct.pack('<H', 1))


def is_a_bomb(folder: Path) -> Path:
    """Expand to a thousand times its own size."""
    return pack(folder, ('my_pkg/my_pkg/bomb.py', b'#' * (16 << 20)))


def lies_about_its_size(folder: Path) -> Path:
    """Contain a megabyte that its table of contents declares as one byte."""
    path = pack(folder, ('my_pkg/my_pkg/liar.py', b'#' * (1 << 20)))
    return set_bytes(path, b'PK\x01\x02', 24, struct.pack('<I', 1))


def has_two_of_a_name(folder: Path) -> Path:
    """Contain a harmless module and a second module of the same name."""
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        return pack(folder, (TALKER[0], 'print(2)'))


def has_a_file_that_is_a_folder(folder: Path) -> Path:
    """Contain a module, and a file whose path uses the module as a folder."""
    return pack(folder, (f'{TALKER[0]}/inner.py', 'print(2)'))


def has_thousands_of_files(folder: Path) -> Path:
    """Contain thousands of files."""
    return pack(folder, *((f'my_pkg/{number}.png', '') for number in range(3000)))


def is_a_maze(folder: Path) -> Path:
    """Contain deeply nested folders."""
    return pack(folder, (f'my_pkg/{"deeper/" * 60}end.py', ''))


def has_terminal_codes_in_a_name(folder: Path) -> Path:
    """Contain a file whose name clears the terminal that lists it."""
    return pack(folder, ('my_pkg/\x1b[2Jclean.py', ''))


def turns_its_name_round(folder: Path) -> Path:
    """Contain a file whose name is displayed backwards, so that it looks like a Python file."""
    return pack(folder, ('my_pkg/\u202eyp.txt', ''))


def is_cut_off(folder: Path) -> Path:
    """End within its table of contents."""
    path = pack(folder)
    path.write_bytes(path.read_bytes()[:-30])
    return path


def is_packed_strangely(folder: Path) -> Path:
    """Use a compression method that needs a lot of memory to decompress."""
    info = entry('my_pkg/my_pkg/odd.py')
    info.compress_type = zipfile.ZIP_BZIP2
    return pack(folder, (info, 'x = 1'))


REFUSED: dict[Callable[[Path], Path], str] = {
    climbs_out: 'a path that leads out of the folder',
    climbs_out_later: 'a path that leads out of the folder',
    is_absolute: 'an absolute path',
    links_out: 'a link or a special file',
    writes_through_a_link: 'a link or a special file',
    holds_a_pipe: 'a link or a special file',
    holds_a_device: 'a link or a special file',
    is_encrypted: 'an encrypted file',
    is_a_bomb: 'more than 1 MiB',
    lies_about_its_size: 'a damaged entry',
    has_two_of_a_name: 'twice',
    has_a_file_that_is_a_folder: 'both a file and a folder',
    has_thousands_of_files: 'more than 2000 files',
    is_a_maze: 'a path that is far too long',
    has_terminal_codes_in_a_name: 'unprintable characters',
    turns_its_name_round: 'unprintable characters',
    is_cut_off: 'the zip file cannot be read',
    is_packed_strangely: 'an unsupported compression method',
}
"""The expected error message for each zip."""
