"""
Read from standard error which exception ended a program, and in which line of the learner's code.

If there are several tracebacks, the last one ended the program.  Two kinds are skipped: exceptions
that Python reports as ignored, and exceptions in an ``except`` or ``finally`` block about a name
that was never assigned.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
import re

from autograder.exam.exam import Run
from autograder.exam.scenario import Names
from autograder.judging.causes.redaction import drawn_values, PUBLIC
from autograder.submission.code.program import without_strings

_HEAD = 'Traceback (most recent call last)'
_IGNORED = 'Exception ignored in'
_DURING = 'During handling of the above exception'
_FRAME = re.compile(r'\s+File "(?P<path>[^"]*/(?P<file>[A-Za-z0-9_]+\.py))", line (?P<line>\d+)')
_INSTALLED = re.compile(r'/(?:lib/python3[\d.]*|site-packages|dist-packages)/')
_EXECUTOR = re.compile(r'\s+File "[^"]*rclpy/executors\.py"')
_ERROR = re.compile(r'[A-Za-z_][\w.]*(?::|$)')
_LOOSE = re.compile(r'[A-Za-z_][\w.]*(?:Error|Exception)\b')
_UNMADE = re.compile(r"(?:UnboundLocalError|NameError): .{0,40}?'(\w{1,60})'")
_PATH = re.compile(r' \((?:/[^()\n]*|unknown location)\)')

LONGEST = 400
"""Maximum length of a line of code that is read [characters]; searching longer lines is slow."""


@dataclass(frozen=True)
class Traceback:
    """
    The exception that ended a program.

    :param error: type and message, one line
    :param line: line in the student's file, None if the traceback names none
    :param source: all Python code of the student
    :param spun: whether this line only spins, and the executor raised the exception
    """

    error: str
    line: int | None
    code: str = ''
    source: str = ''
    spun: bool = False
    names: Names = field(default_factory=Names)

    @property
    def kind(self) -> str:
        """Return the class name of the exception."""
        return self.error.partition(':')[0].rpartition('.')[2]

    @property
    def place(self) -> int | None:
        """Return the line that raised the exception, None if this line only spins."""
        return None if self.spun else self.line

    @cached_property
    def said(self) -> str:
        """Return the exception's class name and message, then the line as in ``bare_code``."""
        return f'{self.kind}{self.error[len(self.error.partition(":")[0]) :]}\n{self.bare_code}'

    @cached_property
    def bare_code(self) -> str:
        """Return the line without its comments and strings."""
        return without_strings(self.code)

    @cached_property
    def bare(self) -> str:
        """Return all of the student's code without its comments and strings."""
        return without_strings(self.source)

    @cached_property
    def own(self) -> frozenset[str]:
        """Return the names of classes, functions and methods that the student's files define."""
        return frozenset(re.findall(r'\b(?:class|def) (\w+)', self.bare))


def traceback_of(run: Run, said: str | None = None) -> Traceback | None:
    """
    Return the exception at the end of a text, None if there is none.

    :param said: what the program printed, by default its standard error
    """
    said = str(run.recording.process.get('stderr', '')) if said is None else said
    source = '\n'.join(text for name, text in run.files.items() if name.endswith('.py'))
    lines = _last_traceback(said.splitlines(), source)
    error = _error_of(lines)
    if not error:
        return None
    error = _without_secrets(run, error)
    texts = {name.rpartition('/')[2]: text for name, text in run.files.items()}
    # The grader puts nodes from notebook cells into the folder with the package's name.
    names = [*run.files, *(f'{run.facts.get("package", "")}/{name}' for name in run.files)]
    frames = [
        (at, found)
        for at, line in enumerate(lines)
        if (found := _FRAME.match(line)) and _is_learners(found['path'], names)
    ]
    spun = any(_EXECUTOR.match(line) for line in lines[frames[-1][0] if frames else 0 :])
    if not frames:
        return Traceback(error, None, source=source, spun=spun, names=run.names)
    file, number = frames[-1][1]['file'], int(frames[-1][1]['line'])
    code = ''.join(texts[file].splitlines()[number - 1 : number]).strip()[:LONGEST]
    return Traceback(error, number, code, source, spun, run.names)


def _is_learners(path: str, names: Iterable[str]) -> bool:
    """
    Return whether a frame is in one of the student's files.

    A module of a package may have the name of a library module, such as ``node.py``.  In the
    path of an installed module, the folder must match too.
    """
    parts = 2 if _INSTALLED.search(path) else 1
    tail = path.split('/')[-parts:]
    return any(name.split('/')[-parts:] == tail for name in names)


def _last_traceback(lines: Sequence[str], source: str) -> Sequence[str]:
    """Return the lines of the traceback that ended the program, or all if there is none."""
    starts = [at for at, line in enumerate(lines) if line.startswith(_HEAD)]
    if not starts:
        return lines
    parts = [
        (lines[max(0, start - 2) : start], lines[start:end])
        for start, end in zip(starts, [*starts[1:], len(lines)], strict=True)
    ]
    parts = [part for part in parts if not any(line.startswith(_IGNORED) for line in part[0])]
    while len(parts) > 1:
        above, last = parts[-1]
        unmade = _UNMADE.match(_error_of(last))
        # If the first exception prevents an assignment, cleaning up the missing object fails too:
        # skip this second exception.
        made = unmade and re.search(rf'\b{unmade[1]}\s*=(?!=)', source)
        if not made or not any(line.startswith(_DURING) for line in above):
            break
        parts.pop()
    return parts[-1][1] if parts else ()


def _error_of(lines: Sequence[str]) -> str:
    """Return type and message of an exception as one line, without absolute paths."""
    frames = [at for at, line in enumerate(lines) if _FRAME.match(line)]
    below = lines[frames[-1] + 1 :] if frames else ()
    error = next((line for line in below if line and not line[0].isspace()), '')
    if not _ERROR.match(error):
        # If Python fails while it starts, there is no frame: use the last line that looks like
        # an error.
        error = next((line for line in reversed(lines) if _LOOSE.match(line)), '')
    return _PATH.sub('', error)[:200]


def _without_secrets(run: Run, error: str) -> str:
    """Remove the message of an exception if it contains an input of a hidden exam."""
    if not run.secret:
        return error
    for value in drawn_values(run):
        shown = f'{value:g}' if isinstance(value, float) else str(value)
        if shown not in PUBLIC and (shown in error or str(value) in error):
            return error.partition(':')[0]
    return error
