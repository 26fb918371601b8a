"""
Keep what CMake found out about compilers and Python while it built the course's own package.

A message package asks for the same again each time, and it is most of what CMake does there: 2.8
of 3.7 s of processor time.  The grader's builds start from these notes.  They are no more than a
short cut: where one is missing or does not fit any more, CMake looks for itself.
"""

from __future__ import annotations

from pathlib import Path
import re
import shutil

from environment.places import COURSE_PACKAGE, Places, write_atomically

# An entry of CMakeCache.txt is NAME:TYPE=VALUE.
ENTRY = re.compile(r'^(\w+):\w+=(.*)$', re.M)
COMPILERS = ('CMakeSystem.cmake', 'CMakeCCompiler.cmake', 'CMakeCXXCompiler.cmake')
# How FindPython lists an interpreter's properties; the ABI of extension modules comes seventh.
MAJOR, MINOR, PATCH, SOABI = 1, 2, 3, 6


def keep(places: Places) -> bool:
    """
    Copy CMake's notes from the workspace's build folder to where the CMake files are.

    :returns: whether there were any of the known form
    """
    built, known = places.workspace / 'build' / COURSE_PACKAGE, places.cmake / 'known'
    shutil.rmtree(known, ignore_errors=True)
    try:
        cache = dict(ENTRY.findall((built / 'CMakeCache.txt').read_text('utf-8')))
        python, compilers = _python(cache), _initial(cache)
    except (OSError, KeyError, IndexError):
        return False
    write_atomically(known / 'python.cmake', python)
    write_atomically(known / 'compilers.cmake', compilers)
    for note in _compilers(built):
        (known / note.parent.name).mkdir(exist_ok=True)
        shutil.copyfile(note, known / note.parent.name / note.name)
    return True


def _compilers(built: Path) -> list[Path]:
    """Return the notes about compilers, in a folder named by CMake's version, or none."""
    for folder in built.glob('CMakeFiles/[0-9]*'):
        notes = [folder / name for name in COMPILERS]
        if all(note.is_file() for note in notes):
            return notes
    return []


def _initial(cache: dict[str, str]) -> str:
    """Return an initial cache that says that the compilers are known, for ``cmake -C``."""
    known = ('CMAKE_PLATFORM_INFO_INITIALIZED', 'CMAKE_EXECUTABLE_FORMAT')
    return ''.join(f'set({name} "{cache[name]}" CACHE INTERNAL "")\n' for name in known)


def _python(cache: dict[str, str]) -> str:
    """Return the variables that KnownPython3.cmake reads, from CMake's cache."""
    properties = cache['_Python3_INTERPRETER_PROPERTIES'].split(';')
    found = {
        'EXECUTABLE': cache['_Python3_EXECUTABLE'],
        'INCLUDE_DIRS': cache['_Python3_INCLUDE_DIR'],
        'NumPy_INCLUDE_DIRS': cache['_Python3_NumPy_INCLUDE_DIR'],
        'VERSION_MAJOR': properties[MAJOR],
        'VERSION_MINOR': properties[MINOR],
        'VERSION_PATCH': properties[PATCH],
        'SOABI': properties[SOABI],
    }
    return ''.join(f'set(Python3_{name} "{value}")\n' for name, value in found.items())
