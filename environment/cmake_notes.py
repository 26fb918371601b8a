"""
Keep results of the course package's build, to speed up the grader's builds.

In each build of a message package, CMake searches for Python again (2 s of CPU time) and the
compiler parses the same headers again (1.3 s).  The grader's builds reuse the stored results.
They are only an optimisation: if one is missing or no longer valid, CMake searches again and the
compiler parses the headers.
"""

import os
from pathlib import Path
import re
import shlex
import shutil
import subprocess

from environment.places import Places, write_atomically

# An entry of CMakeCache.txt is NAME:TYPE=VALUE.
ENTRY = re.compile(r'^(\w+):\w+=(.*)$', re.M)
# Headers to precompile: file name, language as named by CMake and by GCC, suffix of the target in
# the course's package that has the right options, and prefix of the defines to keep.
HEADERS = (
    ('fast_dds.hpp', 'CXX', 'c++', 'rosidl_typesupport_fastrtps_c', '-DFASTCDR'),
    ('python_api.h', 'C', 'c', 'rosidl_generator_py', '-DPy_'),
)
# Matches in a Makefile: "# compile CXX with /usr/bin/c++", "CXX_FLAGS = -O3 -std=gnu++17 -fPIC".
SETTING = re.compile(r'^(?:# (?=compile))?(C(?:XX)?_\w+|compile \w+ with)(?: =)? (.*)$', re.M)
# A precompiled header is valid if these options are equal; a grader's build does not optimise.
KEPT_OPTIONS = ('-std', '-f', '-W')
# Indices into FindPython's list of interpreter properties; 6 is the ABI of extension modules.
MAJOR, MINOR, PATCH, SOABI = 1, 2, 3, 6


def keep(places: Places) -> bool:
    """
    Copy CMake's results from the workspace's build folder to the folder of the CMake files.

    :returns: False if there were none in the known format
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
    for name, language, called, target, defines in HEADERS:
        flags = built / 'CMakeFiles' / f'{package}__{target}.dir' / 'flags.make'
        shutil.copyfile(places.cmake / name, known / name)
        _precompile(known / name, flags, language, called, defines)
    return True


def _precompile(header: Path, flags: Path, language: str, called: str, defines: str) -> None:
    """
    Compile a header with the options of the build; if that fails, leave no compiled file.

    :param header: the header; GCC looks for the compiled file next to it, with suffix ``.gch``
    :param flags: file with CMake's options for a target
    :param language: CMake's name of the language
    :param called: GCC's name of the language
    :param defines: prefix of the defines that affect the headers; GCC requires the same ones later
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
