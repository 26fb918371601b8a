"""
Keep what the build of the course's own package found out, for the builds of the grader.

In each build of a message package, CMake looks for Python again, 2 s of CPU time, and the compiler
reads the same headers again, 1.3 s.  The grader's builds start from these notes.  They are only a
short cut: if a note is missing or no longer fits, CMake searches again and the compiler reads the
headers.
"""

from __future__ import annotations

import os
from pathlib import Path
import re
import shlex
import shutil
import subprocess

from environment.places import Places, PROJECT, write_atomically

STAND_IN = PROJECT / 'autograder' / 'inside' / 'hand_over.py'
"""Replaces Python in CMake's steps of the grader's builds, which saves many starts of Python."""
LONGEST_FIRST_LINE = 127  # of a script, on every kernel: execve(2)
# An entry of CMakeCache.txt is NAME:TYPE=VALUE.
ENTRY = re.compile(r'^(\w+):\w+=(.*)$', re.M)
# Headers that are compiled: the name, the language as CMake and as GCC call it, the target of the
# course's own package that tells the options (after its name), and what is taken of its defines.
HEADERS = (
    ('fast_dds.hpp', 'CXX', 'c++', 'rosidl_typesupport_fastrtps_c', '-DFASTCDR'),
    ('python_api.h', 'C', 'c', 'rosidl_generator_py', '-DPy_'),
)
# Of a Makefile: "# compile CXX with /usr/bin/c++", "CXX_FLAGS = -O3 -std=gnu++17 -fPIC -Wall".
SETTING = re.compile(r'^(?:# (?=compile))?(C(?:XX)?_\w+|compile \w+ with)(?: =)? (.*)$', re.M)
# A precompiled header fits where these are the same; a grader's build does not optimise.
KEPT_OPTIONS = ('-std', '-f', '-W')
# How FindPython lists an interpreter's properties; the ABI of extension modules comes seventh.
MAJOR, MINOR, PATCH, SOABI = 1, 2, 3, 6


def keep(places: Places) -> bool:
    """
    Copy CMake's notes from the workspace's build folder to where the CMake files are.

    :returns: whether there were any of the known form
    """
    package = places.package_name
    built, known = places.workspace / 'build' / package, places.cmake / 'known'
    shutil.rmtree(known, ignore_errors=True)
    try:
        cache = dict(ENTRY.findall((built / 'CMakeCache.txt').read_text('utf-8')))
        python = _python(cache)
    except (OSError, KeyError, IndexError):
        return False
    write_atomically(known / 'python.cmake', python)
    _write_stand_in(known / 'python', cache['_Python3_EXECUTABLE'])
    for name, language, called, target, defines in HEADERS:
        flags = built / 'CMakeFiles' / f'{package}__{target}.dir' / 'flags.make'
        shutil.copyfile(places.cmake / name, known / name)
        _precompile(known / name, flags, language, called, defines)
    return True


def _write_stand_in(path: Path, python: str) -> None:
    """Write the Python that CMake finds, if a script's first line can name it."""
    first = f'#!{python} -SE\n'
    if len(first) <= LONGEST_FIRST_LINE and len(first.split()) == len(('python', '-SE')):
        write_atomically(path, first + STAND_IN.read_text('utf-8'))
        path.chmod(0o755)


def _precompile(header: Path, flags: Path, language: str, called: str, defines: str) -> None:
    """
    Compile a header with the options that the build had; or leave nothing.

    :param header: beside it GCC looks for the compiled one, ``.gch``
    :param flags: CMake's options of a target
    :param language: as CMake calls it
    :param called: what GCC calls it
    :param defines: how those begin that the headers look at; GCC wants the same ones later
    """
    compiled = header.with_name(f'{header.name}.gch')
    try:
        said = dict(SETTING.findall(flags.read_text('utf-8')))
        options = shlex.split(f'{said[f"{language}_FLAGS"]} {said[f"{language}_DEFINES"]}')
        options = [option for option in options if option.startswith((*KEPT_OPTIONS, defines))]
        options += shlex.split(said[f'{language}_INCLUDES'])
        for step in (
            ['-x', f'{called}-header', str(header), '-o', str(compiled)],
            ['-Werror', '-Winvalid-pch', '-include', str(header)]
            + ['-x', called, os.devnull, '-o', os.devnull, '-c'],
        ):
            command = [said[f'compile {language} with'], *options, *step]
            subprocess.run(command, check=True, capture_output=True)
    except (OSError, KeyError, subprocess.CalledProcessError):
        compiled.unlink(missing_ok=True)


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
