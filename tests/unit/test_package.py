"""A package folder as files: where nodes may lie, and what is left out."""

import pytest

from autograder.exam import catalog
from autograder.submission.package import own_files, read_package
from autograder.submission.tree import NotTakenInError


def test_nodes_of_the_inner_folder_and_of_the_top_have_the_same_names(tmp_path):
    """The exams know a node by its file name."""
    for name in ('msg/A.msg', 'package.xml', 'CMakeLists.txt', 'pkg/talker.py', 'listener.py'):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name)

    assert read_package(tmp_path) == {
        'CMakeLists.txt': 'CMakeLists.txt',
        'listener.py': 'listener.py',
        'msg/A.msg': 'msg/A.msg',
        'package.xml': 'package.xml',
        'talker.py': 'pkg/talker.py',
    }


def test_hidden_files_and_other_kinds_are_left_out(tmp_path):
    """Only what a build could need."""
    (tmp_path / '.part.py').write_text('x')
    (tmp_path / '__pycache__').mkdir()
    (tmp_path / '__pycache__' / 'a.py').write_text('x')
    (tmp_path / 'log').mkdir()
    (tmp_path / 'log' / 'latest').symlink_to('build_now')
    (tmp_path / 'core').write_text('x')

    assert read_package(tmp_path) == {}


@pytest.mark.parametrize('target', ['/etc/passwd', '/etc'])
def test_link_is_refused_with_its_name(tmp_path, target):
    """Without its target, the check would say that nothing was saved."""
    (tmp_path / 'pkg').symlink_to(target)

    with pytest.raises(NotTakenInError, match=r'pkg: expected a file or folder, got a link'):
        read_package(tmp_path)


def test_odd_bytes_are_replaced(tmp_path):
    """The compiler says what is wrong with them."""
    (tmp_path / 'a.py').write_bytes(b'x = "\xff"')

    assert read_package(tmp_path) == {'a.py': 'x = "\ufffd"'}


def test_a_message_is_built_without_the_nodes_of_other_exercises():
    """As in grading; and an edit of a node builds nothing again."""
    files = {'package.xml': '', 'msg/Temperature.msg': '', 'temp_publisher.py': 'a node'}
    message = catalog.load('temperature_message', hidden=False)
    publisher = catalog.load('temperature_publisher', hidden=False)

    assert sorted(own_files(message, files)) == ['msg/Temperature.msg', 'package.xml']
    assert own_files(publisher, files) == files
