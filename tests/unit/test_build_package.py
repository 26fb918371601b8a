"""The grader adds missing files to a Python package that was handed in as cells."""

import importlib

import pytest

from autograder.sandboxes.sandbox import HERE


@pytest.fixture
def build_package(monkeypatch):
    """Return the script, which runs inside the sandbox."""
    monkeypatch.syspath_prepend(str(HERE / 'inside'))
    return importlib.import_module('build_package')


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob('*.*'))


def written(folder, *files):
    for name in files:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).touch()
    return folder


def test_cells_become_a_package(build_package, tmp_path):
    """A node goes into the inner folder, and every other file stays where it is."""
    folder = written(tmp_path, 'setup.py', 'a.py', 'config/a.yaml')
    build_package.add_package_files(folder, 'pack')

    assert names(folder) == ['config/a.yaml', 'pack/__init__.py', 'pack/a.py', 'setup.py']
    assert (folder / 'resource' / 'pack').is_file()


@pytest.mark.parametrize(
    'files',
    [
        ('CMakeLists.txt', 'a.py'),
        ('setup.py', 'a.py', 'pack/__init__.py'),
        ('setup.py', 'a.py', 'resource/pack'),
    ],
)
def test_whole_package_stays_as_it_is(build_package, tmp_path, files):
    """The grader adds nothing to a whole package: its mistakes are the student's."""
    before = names(written(tmp_path, *files))
    build_package.add_package_files(tmp_path, 'pack')

    assert names(tmp_path) == before
