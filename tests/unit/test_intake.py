"""A script, a folder or a zip is read safely and completely, or refused."""

import zipfile

import pytest

from autograder.submission import intake
from autograder.submission.intake import in_package, read_handed_in, with_node_files
from autograder.submission.tree import NotTakenInError


def zip_of(path, entries):
    """Write a zip file of (name or ZipInfo, text) pairs."""
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, text in entries:
            archive.writestr(name, text)
    return path


PACKAGE = [
    ('my_pkg/package.xml', '<package/>'),
    ('my_pkg/my_pkg/talker.py', 'x = 1'),
    ('my_pkg/my_pkg/helper.py', 'y = 2'),
    ('my_pkg/setup.cfg', '[develop]'),
    ('my_pkg/resource/my_pkg', ''),
]


class TestWhatIsTakenIn:
    """The three forms give the same files with the same names."""

    def test_a_zip_and_its_folder_are_the_same(self, tmp_path):
        """The folder around the package has no meaning."""
        folder = tmp_path / 'anything'
        for name, text in PACKAGE:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)

        from_folder = read_handed_in(folder)
        from_zip = read_handed_in(zip_of(tmp_path / 'a.zip', PACKAGE))

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

        assert read_handed_in(tmp_path / 'talker.py') == {'talker.py': 'x = 1'}

    def test_what_tools_make_is_left_out(self, tmp_path):
        extra = [
            ('my_pkg/build/a.py', 'x'),
            ('my_pkg/.git/config.txt', 'x'),
            ('__MACOSX/my_pkg/package.xml', 'x'),
            ('my_pkg/my_pkg/__pycache__/a.py', 'x'),
            ('my_pkg/picture.png', 'x'),
        ]

        found = read_handed_in(zip_of(tmp_path / 'a.zip', [*PACKAGE, *extra]))

        assert len(found) == len(PACKAGE)

    @pytest.mark.parametrize('target', ['/etc/passwd', '/etc', '/nowhere'])
    def test_link_in_a_folder_is_refused_as_in_a_zip(self, tmp_path, target):
        """Leaving out a link would change the program that is judged."""
        (tmp_path / 'package.xml').write_text('x')
        (tmp_path / 'linked.py').symlink_to(target)

        with pytest.raises(NotTakenInError, match=r"'linked\.py': .* got a link .* with copies"):
            read_handed_in(tmp_path)

    def test_two_packages_are_one_too_many(self, tmp_path):
        """The refusal names the packages."""
        both = [*PACKAGE, ('other/package.xml', 'x')]

        with pytest.raises(NotTakenInError, match=r'expected one package, got 2: my_pkg, other'):
            read_handed_in(zip_of(tmp_path / 'a.zip', both))

    def test_anything_else_is_refused_by_name(self, tmp_path):
        (tmp_path / 'a.tar').write_text('x')

        with pytest.raises(NotTakenInError, match=r'a\.tar: expected .* got another file'):
            read_handed_in(tmp_path / 'a.tar')
        with pytest.raises(NotTakenInError, match='no file or folder of this name'):
            read_handed_in(tmp_path / 'b.zip2')


class TestWhatAZipMayNotHold:
    """What ``tests/attacks/archives.py`` does not try."""

    @pytest.mark.parametrize(
        ('entry', 'said'),
        [
            ('C:/evil.py', 'an absolute path'),
            ('a//evil.py', 'a path that leads out of the folder'),
            ('a\\evil.py', 'unprintable characters'),
            (f'{"a" * 300}.py', 'a path that is far too long'),
            (f'{"a/" * 20}evil.py', 'more than 12 deep'),
        ],
    )
    def test_an_entry_that_is_no_regular_file_inside(self, tmp_path, entry, said):
        """The refusal has the entry and the reason."""
        path = zip_of(tmp_path / 'a.zip', [*PACKAGE, (entry, 'x')])

        with pytest.raises(NotTakenInError, match=said):
            read_handed_in(path)

    def test_the_whole_is_bounded_too(self, tmp_path, monkeypatch):
        monkeypatch.setattr(intake, 'LARGEST_WHOLE', 1000)
        many = [(f'a{number}.py', 'x' * 300) for number in range(5)]

        with pytest.raises(NotTakenInError, match='more than'):
            read_handed_in(zip_of(tmp_path / 'a.zip', many))

    def test_so_is_the_number_of_files(self, tmp_path):
        many = [(f'a{number}.py', '') for number in range(intake.MOST_FILES + 1)]
        with pytest.raises(NotTakenInError, match=f'more than {intake.MOST_FILES}'):
            read_handed_in(zip_of(tmp_path / 'a.zip', many))

        many = [(f'a{number}.png', '') for number in range(intake.MOST_ENTRIES + 1)]
        with pytest.raises(NotTakenInError, match=f'more than {intake.MOST_ENTRIES} files'):
            read_handed_in(zip_of(tmp_path / 'b.zip', many))

    @pytest.mark.parametrize('data', [b'', b'not a zip', b'PK\x05\x06' + b'\0' * 10])
    def test_what_is_no_zip_is_one_line(self, tmp_path, data):
        """A truncated zip is one line, like a file that is not a zip."""
        (tmp_path / 'a.zip').write_bytes(data)

        with pytest.raises(NotTakenInError, match='the zip file cannot be read'):
            read_handed_in(tmp_path / 'a.zip')

    def test_a_link_to_a_zip_is_none(self, tmp_path):
        zip_of(tmp_path / 'a.zip', PACKAGE)
        (tmp_path / 'b.zip').symlink_to(tmp_path / 'a.zip')

        with pytest.raises(NotTakenInError, match='regular file'):
            read_handed_in(tmp_path / 'b.zip')


class TestNodeFiles:
    """Exams know a node by the file of its executable."""

    def test_a_module_of_that_name_is_found_in_its_package(self):
        """The file in the package stays, so that other modules can import it."""
        files = {'pkg/talker.py': 'node', 'test/talker.py': 'test', 'launch/talker.py': 'launch'}

        assert with_node_files(files, ['talker.py']) == {**files, 'talker.py': 'node'}

    def test_an_entry_point_names_another_module(self):
        files = {'setup.py': "'talker = pkg.node_one:main',", 'pkg/node_one.py': 'node'}

        assert with_node_files(files, ['talker.py'])['talker.py'] == 'node'

    def test_entry_point_comes_before_a_file_at_the_top(self):
        """``ros2 run`` starts the entry point's module, not a forgotten file."""
        setup = "# 'talker = pkg.old:main',\n'talker = pkg.node_one:main',"
        files = {'setup.py': setup, 'pkg/node_one.py': 'node', 'pkg/old.py': 'old'}

        found = with_node_files({**files, 'talker.py': 'forgotten'}, ['talker.py'])

        assert found['talker.py'] == 'node'

    def test_installed_file_comes_before_others_of_its_name(self):
        files = {'talker.py': 'old', 'a/talker.py': 'old', 'scripts/talker.py': 'node'}
        files['CMakeLists.txt'] = '# a/talker.py\ninstall(PROGRAMS scripts/talker.py DESTINATION'

        assert with_node_files(files, ['talker.py'])['talker.py'] == 'node'

    def test_entry_point_of_a_module_at_the_top_leaves_it_as_it_is(self):
        """The module must not import itself."""
        files = {'setup.py': "'talker = talker:start'", 'talker.py': 'node'}

        assert with_node_files(files, ['talker.py']) == files

    def test_an_entry_point_may_call_another_function(self):
        """The file is then the one that ROS would write for the entry point."""
        files = {'setup.cfg': 'talker = pkg.node_one:start\n', 'pkg/node_one.py': 'node'}

        text = with_node_files(files, ['talker.py'])['talker.py']

        assert text == 'import sys\n\nfrom pkg.node_one import start\n\nsys.exit(start())\n'

    def test_a_file_at_the_top_is_not_replaced(self):
        """A file at the top is what was handed in under that name."""
        files = {'talker.py': 'mine', 'pkg/talker.py': 'other'}

        assert with_node_files(files, ['talker.py']) == files

    def test_without_a_package_file_the_only_folder_is_the_package(self):
        """Beginners hand in nodes without a package.xml."""
        assert in_package({'my/a.py': '1', 'my/b.py': '2'}, 'x') == {'a.py': '1', 'b.py': '2'}
        assert in_package({'my/a.py': '1', 'b.py': '2'}, 'x') == {'my/a.py': '1', 'b.py': '2'}
