"""What CMake found during the set-up is saved for later builds, if its format is known."""

import shutil
import subprocess

import pytest

from environment.cmake_notes import HEADERS, keep
from environment.places import Places

CACHE = """# comment
Python3_EXECUTABLE:UNINITIALIZED=/other/python
_Python3_EXECUTABLE:INTERNAL=/venv/bin/python
_Python3_INCLUDE_DIR:INTERNAL=/include/python3.12
_Python3_INTERPRETER_PROPERTIES:INTERNAL=Python;3;12;1;64;<none>;cpython-312-x86_64;abi3;/lib
_Python3_NumPy_INCLUDE_DIR:INTERNAL=/venv/numpy/include
"""

COURSE_PACKAGE = 'temp_monitor_pkg'


@pytest.fixture
def places(tmp_path):
    """Return a set-up whose workspace has been built."""
    found = Places(tmp_path)
    build = found.workspace / 'build' / COURSE_PACKAGE
    (build / 'CMakeFiles').mkdir(parents=True)
    (build / 'CMakeCache.txt').write_text(CACHE, encoding='utf-8')
    found.cmake.mkdir(parents=True)
    for name, *_ in HEADERS:
        (found.cmake / name).touch()
    return found


def test_python_is_kept(places):
    assert keep(places)

    lines = (places.cmake / 'known' / 'python.cmake').read_text().splitlines()
    assert 'set(Python3_EXECUTABLE "/venv/bin/python")' in lines
    assert 'set(Python3_VERSION_MINOR "12")' in lines
    assert 'set(Python3_SOABI "cpython-312-x86_64")' in lines


@pytest.mark.parametrize('gone', ['_Python3_INCLUDE_DIR', 'all'])
def test_a_cache_of_another_form_leaves_nothing(places, gone):
    """From an unknown cache, no notes are saved, because incomplete notes would break builds."""
    keep(places)
    cache = places.workspace / 'build' / COURSE_PACKAGE / 'CMakeCache.txt'
    if gone == 'all':
        cache.unlink()
    else:
        cache.write_text(CACHE.replace(gone, 'renamed'), encoding='utf-8')

    assert not keep(places)
    assert not (places.cmake / 'known').exists()


HEADER, _, _, TARGET, _ = HEADERS[0]
MAKEFILE = """# CMAKE generated file: DO NOT EDIT!
# compile CXX with {compiler}
CXX_DEFINES = -DFASTCDR_SHARED -DBUILDING_{package}
CXX_INCLUDES = -isystem {folder}
CXX_FLAGS = -O3 -DNDEBUG -std=gnu++17 -fPIC -Wall
"""


@pytest.fixture
def header(places, tmp_path):
    """Return the header that is compiled, in a set-up whose build compiled C++."""
    text = MAKEFILE.format(compiler=shutil.which('c++'), package=COURSE_PACKAGE, folder=tmp_path)
    build = places.workspace / 'build' / COURSE_PACKAGE / 'CMakeFiles'
    flags = build / f'{COURSE_PACKAGE}__{TARGET}.dir' / 'flags.make'
    flags.parent.mkdir()
    flags.write_text(text, encoding='utf-8')
    (tmp_path / 'types.hpp').write_text('struct Reading { double value; };\n')
    source = places.cmake / HEADER
    source.write_text('#include <vector>\n#include "types.hpp"\n')
    return source


def test_headers_are_compiled_for_builds_that_do_not_optimise(places, header):
    """The compiled header has the library's defines, not those of the course's package."""
    assert keep(places)

    kept = places.cmake / 'known' / HEADER
    options = ['-std=gnu++17', '-fPIC', '-Wall', '-DFASTCDR_SHARED', '-DBUILDING_other']
    asked = [*options, '-Werror', '-Winvalid-pch', '-include', str(kept), '-x', 'c++', '-']
    subprocess.run(['c++', *asked, '-fsyntax-only'], input=b'Reading reading{1.0};\n', check=True)


def test_headers_that_do_not_compile_leave_nothing(places, header):
    header.write_text('#include "not_there.hpp"\n')

    assert keep(places)
    assert not list((places.cmake / 'known').glob('*.gch'))
