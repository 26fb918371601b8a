"""Run the steps of the set-up: show progress, keep logs, explain failures, hold the lock."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
import fcntl
import os
from pathlib import Path
import shutil
import subprocess
import sys
import time
from typing import IO, TextIO

from environment.places import write_atomically
from environment.stamps import is_stamped, stamp_of

LAST_LINES = 12


class StepError(Exception):
    """Raised when a step cannot be completed; ``try_this`` says what the user should do."""

    def __init__(self, message: str, try_this: str = '') -> None:
        super().__init__(message)
        self.try_this = try_this


@dataclass
class Screen:
    """
    Shows progress: one updated line on a terminal, plain lines in a pipe, few lines on CI.

    :param live: whether to update one line in place
    :param quiet: whether to omit the line at the start of a step
    """

    out: TextIO = field(default_factory=lambda: sys.stderr)
    live: bool = False
    quiet: bool = False

    @classmethod
    def of(cls, environ: Mapping[str, str]) -> Screen:
        """Return a screen with the settings that suit standard error."""
        ci = environ.get('CI', '').lower() not in ('', '0', 'false')
        dumb = environ.get('TERM', 'dumb') == 'dumb'
        return cls(live=sys.stderr.isatty() and not ci and not dumb, quiet=ci)

    def say(self, text: str) -> None:
        """Write one line."""
        clear = '\r\033[K' if self.live else ''
        print(f'{clear}{text}', file=self.out, flush=True)

    def redraw(self, text: str) -> None:
        """Update the line in place; do nothing unless the screen is live."""
        if self.live:
            width = shutil.get_terminal_size().columns - 1
            print(f'\r\033[K{text[:width]}', end='', file=self.out, flush=True)


@dataclass
class Job:
    """
    The tools with which a step runs commands.

    :param tick: called regularly while a command runs
    :param keep_open: file descriptors that children inherit, for example the lock: an orphaned pip
        of a killed set-up then blocks the next set-up instead of writing at the same time
    """

    log: IO[str]
    tick: Callable[[], None] = lambda: None
    keep_open: tuple[int, ...] = ()

    def run(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        what: str = '',
        cwd: Path | None = None,
    ) -> None:
        """Run a command with its output in the log; a StepError calls the command ``what``."""
        name = what or Path(command[0]).name
        print('$', *command, file=self.log, flush=True)
        try:
            process = subprocess.Popen(
                command,
                env=dict(env),
                cwd=cwd,
                stdin=subprocess.DEVNULL,
                stdout=self.log,
                stderr=subprocess.STDOUT,
                pass_fds=self.keep_open,
            )
        except OSError as error:
            raise StepError(f'{name} did not start: {error}') from error
        code = self._wait(process)
        if code:
            raise StepError(f'{name} ended with code {code}')

    def _wait(self, process: subprocess.Popen[bytes]) -> int:
        try:
            while True:
                try:
                    return process.wait(timeout=0.5)
                except subprocess.TimeoutExpired:
                    self.tick()
        except BaseException:
            process.terminate()
            process.wait()
            raise


@dataclass(frozen=True)
class Step:
    """
    One step of the set-up.

    :param name: name of its log and stamp
    :param needed: returns whether the step must run; called after the previous steps
    :param run: does the work; raises StepError
    :param digest: returns the digest of the step's inputs, with which it is stamped when it has
        succeeded; a step whose stamp differs must run, too
    :param about: a hint about the duration
    :param try_this: advice for a failure whose error contains none
    :param optional: whether the set-up is complete even if this step fails
    """

    name: str
    title: str
    needed: Callable[[], bool]
    run: Callable[[Job], None]
    digest: Callable[[], str] | None = None
    about: str = ''
    try_this: str = 'run the same command again: it continues where it stopped'
    optional: bool = False


def run_steps(
    steps: Sequence[Step], notes: Path, screen: Screen, keep_open: tuple[int, ...] = ()
) -> bool:
    """Run the steps that are needed; return False, after printing why, if a required one fails."""
    for number, step in enumerate(steps, start=1):
        # Computed before the step runs: if its inputs change meanwhile, the next run repeats it.
        digest = step.digest() if step.digest else ''
        if not step.needed() and (not digest or is_stamped(notes, step.name, digest)):
            continue
        label = f'[{number}/{len(steps)}] {step.title}'
        hint = f' ({step.about})' if step.about else ''
        if not screen.quiet and not screen.live:
            screen.say(f'{label} ...{hint}')
        started = time.monotonic()
        log_path = notes / 'logs' / f'{step.name}.log'
        log_path.parent.mkdir(parents=True, exist_ok=True)

        def tick(label: str = label, started: float = started, hint: str = hint) -> None:
            screen.redraw(f'{label} ... {time.monotonic() - started:.0f} s{hint}')

        tick()
        with log_path.open('w', encoding='utf-8') as log:
            try:
                step.run(Job(log=log, tick=tick, keep_open=keep_open))
            except StepError as error:
                explain(error, step, label, log_path, screen)
                if step.optional:
                    continue
                return False
        if digest:
            write_atomically(stamp_of(notes, step.name), digest)
        screen.say(f'{label}: done in {time.monotonic() - started:.0f} s')
    return True


def explain(error: StepError, step: Step, label: str, log_path: Path, screen: Screen) -> None:
    """Print which step failed, the end of its log and what to do."""
    screen.say(f'{label}: FAILED: {error}')
    lines = log_path.read_text(encoding='utf-8', errors='replace').splitlines()
    if lines:
        screen.say(f'  the last lines of {log_path}:')
        for line in lines[-LAST_LINES:]:
            screen.say(f'  | {line[:300]}')
    screen.say(f'  try: {error.try_this or step.try_this}')


@contextmanager
def locked(path: Path, screen: Screen) -> Iterator[int]:
    """Hold the lock of the set-up, which the kernel frees; if another holds it, say so, wait."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            screen.say('waiting for another set-up of this folder')
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield handle
    finally:
        os.close(handle)
