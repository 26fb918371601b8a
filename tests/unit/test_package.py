"""Folders, scripts and zips are read safely and completely, or refused."""

import os
import stat
import struct
import zipfile

from collect_sources import laid
import pytest

from autograder.exam import catalog
from autograder.submission import package
from autograder.submission.package import (
    in_package,
    own_files,
    read_package,
    read_upload,
    with_node_files,
)
from autograder.submission.reading import UnusableUploadError


def zip_of(path, entries):
    """Write a zip file of (name or ZipInfo, text) pairs."""
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, text in entries:
            archive.writestr(name, text)
    return path


def refused(path, said):
    with pytest.raises(UnusableUploadError, match=said):
        read_upload(path)


PACKAGE = [
    ('my_pkg/package.xml', '<package/>'),
    ('my_pkg/my_pkg/talker.py', 'x = 1'),
    ('my_pkg/my_pkg/helper.py', 'y = 2'),
    ('my_pkg/setup.cfg', '[develop]'),
    ('my_pkg/resource/my_pkg', ''),
]


class TestWhatIsTakenIn:
    def test_a_zip_and_its_folder_are_the_same(self, tmp_path):
        folder = {name: text.encode() for name, text in PACKAGE}

        from_folder = read_upload(laid(tmp_path / 'anything', folder))
        from_zip = read_upload(zip_of(tmp_path / 'a.zip', PACKAGE))

        assert from_folder == from_zip
        assert sorted(from_zip) == [
            'my_pkg/helper.py',
            'my_pkg/talker.py',
            'package.xml',
            'resource/my_pkg',
            'setup.cfg',
        ]

    def test_a_script_is_one_file(self, tmp_path):
        (tmp_path / 'talker.py').write_text('x = 1')

        assert read_upload(tmp_path / 'talker.py') == {'talker.py': 'x = 1'}

    def test_what_tools_make_is_left_out(self, tmp_path):
        extra = [
            ('my_pkg/build/a.py', 'x'),
            ('my_pkg/.git/config.txt', 'x'),
            ('__MACOSX/my_pkg/package.xml', 'x'),
            ('my_pkg/my_pkg/__pycache__/a.py', 'x'),
            ('my_pkg/picture.png', 'x'),
        ]

        found = read_upload(zip_of(tmp_path / 'a.zip', [*PACKAGE, *extra]))

        assert len(found) == len(PACKAGE)

    @pytest.mark.parametrize('target', ['/etc/passwd', '/etc', '/nowhere'])
    def test_link_in_a_folder_is_refused_as_in_a_zip(self, tmp_path, target):
        """Leaving out a link would change the program that is judged."""
        (tmp_path / 'package.xml').write_text('x')
        (tmp_path / 'linked.py').symlink_to(target)

        refused(tmp_path, r"'linked\.py': .* got a link .* with copies")

    def test_two_packages_are_one_too_many(self, tmp_path):
        both = zip_of(tmp_path / 'a.zip', [*PACKAGE, ('other/package.xml', 'x')])

        refused(both, 'expected one package, got 2: my_pkg, other')

    def test_anything_else_is_refused_by_name(self, tmp_path):
        (tmp_path / 'a.tar').write_text('x')

        refused(tmp_path / 'a.tar', r'a\.tar: expected .* got a different file')
        refused(tmp_path / 'b.zip2', 'no file or folder of this name')


def info(name, **facts):
    """Return a zip entry with these attributes."""
    entry = zipfile.ZipInfo(name)
    for fact, value in facts.items():
        setattr(entry, fact, value)
    return entry


LINK = (stat.S_IFLNK | 0o777) << 16
PIPE = (stat.S_IFIFO | 0o644) << 16
NODES = [f'a{number}.py' for number in range(package.MOST_FILES + 1)]
PICTURES = [f'a{number}.png' for number in range(package.BOUNDS.entries + 1)]


class TestWhatAZipMayNotHold:
    @pytest.mark.parametrize(
        ('entry', 'said'),
        [
            (info('/etc/evil.py'), 'an absolute path'),
            (info('C:/evil.py'), 'an absolute path'),
            (info('../evil.py'), 'a path that leads out of the folder'),
            (info('a/../../evil.py'), 'a path that leads out of the folder'),
            (info('a//evil.py'), 'a path that leads out of the folder'),
            (info('a\\evil.py'), 'a backslash'),
            (info('a\x1b[2J.py'), 'unprintable characters'),
            (info(f'{"a" * 300}.py'), 'a path that is far too long'),
            (info(f'{"a/" * 20}evil.py'), 'more than 12 deep'),
            (info('link.py', external_attr=LINK), 'a link or a special file'),
            (info('pipe.py', external_attr=PIPE), 'a link or a special file'),
            (info('a.py', compress_type=zipfile.ZIP_LZMA), 'an unsupported compression method'),
        ],
    )
    def test_an_entry_that_is_no_regular_file_inside(self, tmp_path, entry, said):
        refused(zip_of(tmp_path / 'a.zip', [*PACKAGE, (entry, 'x')]), said)

    def test_a_bomb_is_counted_while_it_is_read(self, tmp_path, monkeypatch):
        """Unpacked bytes are counted, because a zip bomb is small until it is unpacked."""
        monkeypatch.setattr(package, 'BOUNDS', package.BOUNDS._replace(file_bytes=1 << 16))
        path = zip_of(tmp_path / 'a.zip', [('package.xml', 'a' * (1 << 24))])

        assert path.stat().st_size < 1 << 16
        refused(path, 'expected the files of one package')

    def test_a_size_that_lies_is_not_believed(self, tmp_path):
        path = zip_of(tmp_path / 'a.zip', [('package.xml', 'a' * 100_000)])
        data = bytearray(path.read_bytes())
        directory = data.index(b'PK\x01\x02')
        data[directory + 24 : directory + 28] = struct.pack('<I', 1)
        path.write_bytes(data)

        refused(path, 'a damaged entry')

    def test_the_whole_is_bounded_too(self, tmp_path, monkeypatch):
        monkeypatch.setattr(package, 'BOUNDS', package.BOUNDS._replace(whole_bytes=1000))
        many = [(f'a{number}.py', 'x' * 300) for number in range(5)]

        refused(zip_of(tmp_path / 'a.zip', many), 'more than')

    @pytest.mark.filterwarnings('ignore:Duplicate name')
    @pytest.mark.parametrize(
        ('names', 'said'),
        [
            (NODES, f'more than {package.MOST_FILES}'),
            (PICTURES, f'more than {package.BOUNDS.entries} files'),
            (['a.py', 'a.py'], 'twice'),
            (['a.py', 'a.py/b.py'], 'both a file and a folder'),
        ],
        ids=['files', 'entries', 'twice', 'file and folder'],
    )
    def test_number_of_files_is_bounded_and_a_name_has_one_meaning(self, tmp_path, names, said):
        refused(zip_of(tmp_path / 'a.zip', [(name, '') for name in names]), said)

    @pytest.mark.parametrize('data', [b'', b'not a zip', b'PK\x05\x06' + b'\0' * 10])
    def test_what_is_no_zip_is_one_line(self, tmp_path, data):
        (tmp_path / 'a.zip').write_bytes(data)

        refused(tmp_path / 'a.zip', 'the zip file cannot be read')

    def test_a_link_to_a_zip_is_none(self, tmp_path):
        zip_of(tmp_path / 'a.zip', PACKAGE)
        (tmp_path / 'b.zip').symlink_to(tmp_path / 'a.zip')

        refused(tmp_path / 'b.zip', 'regular file')


ENTRIES = "# 'talker = pkg.old:main',\n'talker = pkg.node_one:main',"
INSTALLS = '# a/talker.py\ninstall(PROGRAMS scripts/talker.py DESTINATION'
OLD = {'talker.py': 'old', 'a/talker.py': 'old'}


@pytest.mark.parametrize(
    'files',
    [
        {'pkg/talker.py': 'node', 'test/talker.py': 'test', 'launch/talker.py': 'launch'},
        {'setup.py': "'talker = pkg.node_one:main',", 'pkg/node_one.py': 'node'},
        # ``ros2 run`` starts the entry point's module, not a forgotten file.
        {'setup.py': ENTRIES, 'pkg/node_one.py': 'node', 'pkg/old.py': 'old', **OLD},
        {'CMakeLists.txt': INSTALLS, 'scripts/talker.py': 'node', **OLD},
        # The module must not import itself.
        {'setup.py': "'talker = talker:start'", 'talker.py': 'node'},
        {'talker.py': 'node', 'pkg/talker.py': 'other'},
    ],
    ids=['in package', 'entry', 'entry before top', 'installed', 'entry at the top', 'at the top'],
)
def test_exams_identify_a_node_by_the_file_name_of_its_executable(files):
    """Its file in the package is kept, so that other modules can import it."""
    assert with_node_files(files, ['talker.py']) == {**files, 'talker.py': 'node'}


def test_an_entry_point_may_call_another_function():
    files = {'setup.cfg': 'talker = pkg.node_one:start\n', 'pkg/node_one.py': 'node'}

    text = with_node_files(files, ['talker.py'])['talker.py']

    assert text == 'import sys\n\nfrom pkg.node_one import start\n\nsys.exit(start())\n'


def test_without_a_package_file_the_only_folder_is_the_package():
    """Beginners may hand in nodes without a package.xml."""
    assert in_package({'my/a.py': '1', 'my/b.py': '2'}, 'x') == {'a.py': '1', 'b.py': '2'}
    assert in_package({'my/a.py': '1', 'b.py': '2'}, 'x') == {'my/a.py': '1', 'b.py': '2'}


def test_nodes_of_the_inner_folder_and_of_the_top_have_the_same_names(tmp_path):
    files = {'CMakeLists.txt': b'', 'listener.py': b'top', 'msg/A.msg': b'', 'package.xml': b''}
    laid(tmp_path, {**files, 'pkg/talker.py': b'inner'})

    found = {name: data.decode() for name, data in files.items()}
    assert read_package(tmp_path) == {**found, 'talker.py': 'inner'}


def test_hidden_files_and_other_kinds_are_left_out(tmp_path):
    laid(tmp_path, {'.part.py': b'x', '__pycache__/a.py': b'x', 'log/a': b'x', 'core': b'x'})
    (tmp_path / 'log' / 'latest').symlink_to('build_now')

    assert read_package(tmp_path) == {}


@pytest.mark.parametrize('target', ['/etc/passwd', '/etc'])
def test_link_is_refused_with_its_name(tmp_path, target):
    """If links were skipped, the check would report that no file was saved."""
    (tmp_path / 'pkg').symlink_to(target)

    with pytest.raises(UnusableUploadError, match=r'pkg: .* got a link.* replace the link with'):
        read_package(tmp_path)


def test_other_entries_of_a_notebooks_folder_are_ignored(tmp_path):
    (tmp_path / '/'.join('d' * 20)).mkdir(parents=True)
    os.mkfifo(tmp_path / 'pipe.py')
    files = {'data.csv': bytes(1_100_000), 'a\\b.txt': b'x', 'package.xml': b'<package/>'}
    laid(tmp_path, files)

    assert read_package(tmp_path)['package.xml'] == '<package/>'
    assert 'pipe.py' not in read_package(tmp_path)


def test_files_of_a_notebook_are_read_up_to_a_limit(tmp_path):
    laid(tmp_path, {f'n{number}.py': b'x' for number in range(package.MOST_FILES + 5)})

    assert len(read_package(tmp_path)) == package.MOST_FILES
    assert read_package(tmp_path / 'missing') == {}


def test_odd_bytes_are_replaced(tmp_path):
    """If the bytes are a mistake, the build or the run reports it."""
    (tmp_path / 'a.py').write_bytes(b'x = "\xff"')

    assert read_package(tmp_path) == {'a.py': 'x = "\ufffd"'}


def test_an_exam_gets_no_nodes_of_other_exercises():
    """Otherwise editing a node would repeat a build, and line numbers would be ambiguous."""
    files = {'package.xml': '', 'msg/Temperature.msg': '', 'temp_publisher.py': 'a node'}
    other = {'temp_subscriber.py': 'another node'}
    message = catalog.load('temperature_message', hidden=False)
    publisher = catalog.load('temperature_publisher', hidden=False)

    assert sorted(own_files(message, files | other)) == ['msg/Temperature.msg', 'package.xml']
    assert own_files(publisher, files | other) == files
