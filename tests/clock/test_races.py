"""
ThreadSanitizer finds no race in the library while programs with many threads use it.

The report names places such as ``clock.so+0x6858``; ``addr2line -e`` finds the line.
"""

import os
from pathlib import Path
import socket
import subprocess

import pytest

from autograder.clock import virtual_clock as clocks
from environment.clock import commands, COMPILER

LIMIT_S = 120.0  # of real time; a pair of programs takes a fraction of a second
SANITIZED = '-fsanitize=thread'
# To name code places, the sanitizer calls functions of the library, some with its lock held.
OPTIONS = {'TSAN_OPTIONS': 'symbolize=0 atexit_sleep_ms=0 die_after_fork=0'}
STYLES = (
    'sleeps',
    'generations',
    'conditions',
    'locks',
    'semaphores',
    'polls',
    'timers',
    'descriptors',
    'datagrams',
    'children',
    'forks',
)


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with library, driver and programs, all compiled with the sanitizer."""
    folder = tmp_path_factory.mktemp('races')
    source, races = Path(__file__).with_name('races.c'), folder / 'races'
    program = [*COMPILER, SANITIZED, '-pthread', str(source), '-o', str(races)]
    for command in (program, *commands(folder, SANITIZED)):
        built = subprocess.run(command, capture_output=True, text=True)
        if 'tsan' in built.stderr:
            pytest.skip(f'gcc has no ThreadSanitizer: {built.stderr.splitlines()[-1]}')
        assert built.returncode == 0, built.stderr
    alone = subprocess.run(
        [races, 'nap'], capture_output=True, text=True, env=os.environ | OPTIONS
    )
    if 'FATAL: ThreadSanitizer' in alone.stderr:
        pytest.skip(f'this kernel refuses ThreadSanitizer: {alone.stderr.splitlines()[0]}')
    assert (alone.returncode, alone.stderr) == (0, '')
    return folder


@pytest.mark.parametrize('style', STYLES)
def test_two_processes_of_many_threads_show_no_race(style, folder, monkeypatch):
    monkeypatch.setattr(clocks, 'FOLDER', folder)
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
    for each in sockets:
        each.bind(('127.0.0.1', 0))
    ports = [each.getsockname()[1] for each in sockets]
    with clocks.virtual_clock(2) as clock:
        programs = [
            subprocess.Popen(
                [folder / 'races', style, str(own.fileno()), str(port)],
                env={**os.environ, **OPTIONS, **clock.variables(place)},
                pass_fds=[clock.places[place].fileno(), own.fileno()],
                stderr=subprocess.PIPE,
                text=True,
            )
            for place, (own, port) in enumerate(zip(sockets, reversed(ports)))
        ]
        clock.begin()
        try:
            said = [program.communicate(timeout=LIMIT_S)[1] for program in programs]
        finally:
            for program in programs:
                program.kill()
            for each in sockets:
                each.close()
    assert said == ['', '']
    assert [program.returncode for program in programs] == [0, 0]
