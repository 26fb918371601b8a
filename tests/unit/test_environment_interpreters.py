"""The Python that the set-up chooses."""

from dataclasses import replace
import json
import os
from pathlib import Path
import subprocess
import sys

from collect_sources import laid
import pytest

from environment import interpreters
from environment.interpreters import Interpreter

GOOD = Interpreter(
    path='/usr/bin/python3.12',
    release='3.12.3',
    implementation='cpython',
    base_prefix='/usr',
    has_venv=True,
    has_headers=True,
    platform='linux-x86_64',
    libc=('glibc', '2.36'),
)


def fake_python(folder, name, **answers):
    """Create a program that answers the set-up like an interpreter."""
    answer = {**vars(GOOD), 'path': str(folder / name), **answers}
    program = folder / name
    program.write_text(f"#!/bin/sh\necho '{json.dumps(answer)}'\n")
    program.chmod(0o755)
    return program


@pytest.mark.parametrize(
    ('found', 'chosen'),
    [
        # Among several complete interpreters, 3.12 is chosen, wherever it is installed.
        ([{'release': f'3.{minor}.1'} for minor in (13, 10, 12, 11)], 2),
        # An incomplete one is chosen only if there is no other; the set-up completes it.
        ([{'has_headers': False}, {'release': '3.10.1'}], 1),
        ([{'has_venv': False}], 0),
        # The distribution's own Python is faster than one built by hand, and is tested as often.
        ([{'base_prefix': '/home/ada/.pyenv/versions/3.12.3'}, {'release': '3.11.2'}], 1),
        # A tested version is preferred to the distribution's own Python.
        ([{'release': '3.13.1'}, {'release': '3.10.1'}, {'base_prefix': '/usr/local'}], 2),
    ],
)
def test_choose_takes_the_best(found, chosen):
    """The criteria, in order: complete, tested, from the distribution, preferred version."""
    interpreters_found = [replace(GOOD, **facts) for facts in found]

    assert interpreters.choose(interpreters_found) == interpreters_found[chosen]


@pytest.mark.parametrize(
    'other', [{'release': '3.9.1'}, {'release': '3.14.0'}, {'implementation': 'pypy'}]
)
def test_choose_unsupported_gives_none(other):
    assert interpreters.choose([replace(GOOD, **other)]) is None


def test_probe_this_python_tells_its_base():
    """The Python of a venv names the interpreter from which the venv was made."""
    answer = interpreters.probe(sys.executable, os.environ)

    assert answer.version == f'{sys.version_info[0]}.{sys.version_info[1]}'
    assert answer.base_prefix == sys.base_prefix
    assert os.path.realpath(answer.path) == os.path.realpath(sys.executable)


@pytest.mark.parametrize('script', ['exit 127', 'echo no json', 'echo "{}"', 'echo []', None])
def test_probe_broken_shim_gives_none(tmp_path, script):
    """A pyenv shim without its version, a broken link, and other output are skipped."""
    shim = tmp_path / 'python3.12'
    if script:
        shim.write_text(f'#!/bin/sh\n{script}\n')
        shim.chmod(0o755)

    assert interpreters.probe(str(shim), {}) is None


def test_find_broken_shim_first_on_path_takes_pyenv_version(tmp_path):
    shims = tmp_path / 'shims'
    real = tmp_path / 'pyenv' / 'versions' / '3.12.1' / 'bin'
    real.mkdir(parents=True)
    laid(shims, {'python3.12': b'#!/bin/sh\nexit 127\n'})
    (shims / 'python3.12').chmod(0o755)
    expected = fake_python(real, 'python3.12')

    found = interpreters.find({'PATH': str(shims), 'PYENV_ROOT': str(tmp_path / 'pyenv')})

    assert found.path == str(expected)


def test_candidates_skip_a_pyenv_that_this_user_may_not_read(tmp_path):
    """A pyenv folder in the home of a different user, as after ``su``, is skipped."""
    closed = tmp_path / 'home'
    (closed / 'pyenv' / 'versions' / '3.12.1' / 'bin').mkdir(parents=True)
    closed.chmod(0)
    code = (
        'import os, sys\n'
        'from environment import interpreters\n'
        'os.geteuid() or os.setuid(65534)\n'  # root can read everything
        'print(*interpreters.candidates({"PATH": "/bin", "PYENV_ROOT": sys.argv[1]}))\n'
    )

    done = subprocess.run(
        [sys.executable, '-c', code, closed / 'pyenv'],
        cwd=Path(interpreters.__file__).parent.parent,
        capture_output=True,
        text=True,
    )
    closed.chmod(0o700)

    assert (done.returncode, done.stderr) == (0, '')
    assert str(closed) not in done.stdout


def test_find_looks_beyond_a_python_built_by_hand(tmp_path):
    fake_python(tmp_path, 'python3.12', base_prefix=str(tmp_path))
    expected = fake_python(tmp_path, 'python3.11', release='3.11.2')

    assert interpreters.find({'PATH': str(tmp_path)}).path == str(expected)


def test_one_in_usr_local_hides_no_other(monkeypatch):
    monkeypatch.setattr(interpreters.shutil, 'which', lambda name, path=None: f'{path}/{name}')

    found = list(interpreters.candidates({'PATH': '/usr/local/bin'}))

    assert {'/usr/local/bin/python3.12', '/usr/bin/python3.12'} <= set(found)


def test_find_request_takes_only_that(tmp_path):
    """With PYTHON=..., no other interpreter is tried."""
    fake_python(tmp_path, 'python3.12')
    fake_python(tmp_path, 'python3.11', release='3.11.2')

    environ = {'PATH': str(tmp_path)}

    assert interpreters.find(environ, 'python3.11').version == '3.11'
    assert interpreters.find(environ, 'python3.10') is None


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        ({}, ''),
        ({'platform': 'macosx-14.0-arm64'}, 'Linux on x86_64'),
        ({'platform': 'linux-aarch64'}, 'Linux on x86_64'),
        ({'libc': ('glibc', '2.27')}, 'glibc 2.28'),
        ({'libc': ('', '')}, 'glibc 2.28'),
    ],
)
def test_wheels_refusal_names_the_reason(change, words):
    refusal = interpreters.wheels_refusal(replace(GOOD, **change))

    assert words in refusal
    assert bool(refusal) == bool(words)
