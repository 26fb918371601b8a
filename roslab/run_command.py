"""
Run a command for a cell with a time limit; an interrupt or the limit ends all its processes.

The command stays in the kernel's process group, so killing the kernel also ends the command.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

import psutil

from autograder.layout import CHOSEN, Layout
from roslab.interrupts import HeldInterrupts
from roslab.output import ElapsedTime

_MOST_BYTES = 2_000_000
_TAIL_BYTES = 4_000
_REAPING_S = 2.0


@dataclass(frozen=True)
class Outcome:
    """
    The outcome of a command.

    :param returncode: exit code, None if the command was ended at its deadline
    :param output: the end of its output on stdout and stderr
    :param seconds: how long the command ran [s]
    """

    returncode: int | None
    output: str
    seconds: float


def run(
    command: Sequence[str],
    *,
    cwd: Path,
    env: Mapping[str, str],
    deadline_s: float,
    on_tick: Callable[[float, str], None] = lambda *_: None,
    tick_s: float = 0.5,
) -> Outcome:
    """
    Run a command until it ends or its deadline passes.

    :param on_tick: called regularly with the elapsed time [s] and the end of the output
    :raises OSError: if the command cannot be started
    """
    begin = time.monotonic()
    # Allow interrupts only while waiting, so that every process that starts is recorded and ended.
    with tempfile.TemporaryFile() as log, HeldInterrupts() as interrupts:
        process = subprocess.Popen(
            command,
            cwd=cwd,
            env=dict(env),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            with interrupts.allowed():
                _wait(
                    process,
                    begin,
                    deadline_s,
                    lambda seconds: on_tick(seconds, _end_of(log.fileno())),
                    tick_s,
                )
        finally:
            ended = process.poll() is not None
            _kill_tree(process)
        size = log.seek(0, 2)
        log.seek(max(0, size - _MOST_BYTES))
        output = log.read().decode('utf-8', 'replace')
    return Outcome(process.returncode if ended else None, output, time.monotonic() - begin)


def run_grader(module: str, *arguments: str, text: str, deadline_s: float) -> Outcome:
    """Run a grader's module on the learner's files, with ``text`` beside the elapsed seconds."""
    # Run in an empty folder: a file next to the notebook must not shadow a module.
    with tempfile.TemporaryDirectory(prefix='check-') as empty, ElapsedTime(text) as elapsed:
        return run(
            [sys.executable, '-m', module, *arguments],
            cwd=Path(empty),
            env={**os.environ, CHOSEN: str(Layout.here().root)},
            deadline_s=deadline_s,
            on_tick=elapsed.tick,
        )


def _end_of(log: int) -> str:
    """Return the last lines of a log that a process is still writing; keep the file offset."""
    size = os.fstat(log).st_size
    return os.pread(log, _TAIL_BYTES, max(0, size - _TAIL_BYTES)).decode('utf-8', 'replace')


def _wait(
    process: subprocess.Popen[bytes],
    begin: float,
    deadline_s: float,
    on_tick: Callable[[float], None],
    tick_s: float,
) -> None:
    while (passed := time.monotonic() - begin) < deadline_s:
        try:
            process.wait(min(tick_s, deadline_s - passed))
            return
        except subprocess.TimeoutExpired:
            on_tick(time.monotonic() - begin)


def _kill_tree(process: subprocess.Popen[bytes]) -> None:
    """Kill a process and all its children, if it is still running."""
    if process.poll() is not None:
        return
    try:
        family = psutil.Process(process.pid).children(recursive=True)
    except psutil.NoSuchProcess:
        family = []
    process.kill()
    for member in family:
        with suppress(psutil.NoSuchProcess):
            member.kill()
    process.wait()
    psutil.wait_procs(family, timeout=_REAPING_S)
