"""
Explain a missing log line: a different logger, a wrong level, ``print()``, or no line at all.

The lines of a node's logger go to the topic ``/rosout`` and, in this course, also to standard
output.  Other text on standard output was printed, or comes from a different logger.  An ERROR
line that an ``except`` block logs differs only in its text from one that the exercise requires.
"""

import ast
from collections.abc import Callable, Iterable, Iterator, Sequence
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.redaction import redacted
from autograder.judging.causes.text_table import cause_of
from autograder.judging.causes.tracebacks import Traceback
from autograder.recording import ERROR, Event, LEVELS
from autograder.submission.code.mistakes import leaves_out, logs_with_python
from autograder.submission.code.program import last_name
from autograder.submission.code.source_code import Code

CALLS = {10: 'debug', 20: 'info', 30: 'warning', 40: 'error', 50: 'fatal'}
Belongs = Callable[[str], bool]
"""Returns whether a text may be the missing line."""

OF_ROS = ('rcl', 'rmw', 'rcutils')
"""Prefixes of the loggers of ROS libraries, which write only to standard output."""
_LOGGED = re.compile(r'\[(DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[([^\]]*)\]: ?(.*)')
_ATTRIBUTE = re.compile(r"'\w{1,40}' object has no attribute '\w{1,60}'")
_PYTHON = re.compile(
    r'has no attribute|is not defined|object is not|not supported between|unsupported operand|'
    r'positional argument|keyword argument|could not convert|can only concatenate|'
    r'not all arguments|not associated with a value|out of range|must be real|'
    r'[Dd]ivision by zero|format code|format string|'
    r'\b(?:Type|Name|Attribute|Key|Index|Assertion|UnboundLocal|ZeroDivision)Error\b'
)
"""Parts of Python's error messages, without ValueError, which correct solutions may log."""


def why_not_logged(
    run: Run, found: Sequence[Event], level: int, belongs: Belongs | None = None
) -> Cause | None:
    """
    Explain a missing log line.

    :param found: lines that were logged instead at that moment
    :param level: level of the missing line
    :param belongs: by default, any line may be the missing one
    """
    if why := why_silent(run) or why_other_logger(run, level, belongs):
        return why
    if why := why_exception_logged(run, found):
        return why
    for one in found:
        if belongs is None or belongs(str(one['text'])):
            other = LEVELS.get(one['level'], one['level'])
            line = one.get('line')
            return cause_of('wrong_level', other=other, call=CALLS[level], line=line)
    if why := why_printed(run, level, belongs):
        return why
    code = Code(run.files)
    if 'debug' in code.calls and not code.calls_to(CALLS[level]):
        return cause_of('debug_level', call=CALLS[level])
    return why_left_out(run, level)


def why_elsewhere(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line that is only on standard output, or missing from a silent program."""
    return (
        why_silent(run)
        or why_other_logger(run, level, belongs)
        or why_printed(run, level, belongs)
    )


def why_other_logger(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line at the right level from a logger that does not belong to any node."""
    own = {node.strip('/').replace('/', '.') for node in run.recording.nodes}
    own |= {str(entry['name']) for entry in run.recording.logs()}
    for severity, name, _ in _on_stdout(run, belongs):
        # Lines of child loggers reach /rosout too, and the libraries of ROS have their own
        # loggers.
        known = name.startswith(OF_ROS) or any(f'{name}.'.startswith(f'{one}.') for one in own)
        if severity == LEVELS[level] and not known and not _imitates_log_lines(run):
            return cause_of('other_logger')
    if run.recording.logs(level=level) or not logs_with_python(run.files, CALLS[level]):
        return None
    return cause_of('other_logger')


def why_left_out(run: Run, level: int, found: Sequence[Event] = ()) -> Cause | None:
    """
    Explain missing lines by a log call or a logger level that leaves lines out.

    :param found: lines that were logged; their line numbers identify the call
    """
    if name := leaves_out(run.files, CALLS[level], lines_of_code(found)):
        return cause_of('left_out', name=name, call=CALLS[level])
    for call in Code(run.files).calls.get('set_level', ()):
        named = set(map(last_name, ast.walk(call)))
        if hidden := [one for number, one in LEVELS.items() if number > level and one in named]:
            return cause_of('set_level', level=hidden[0], call=CALLS[level])
    return None


def lines_of_code(found: Iterable[Event]) -> set[int]:
    """Return the line numbers of the log calls for some log lines."""
    return {int(one['line']) for one in found if one.get('line')}


def why_printed(
    run: Run, level: int, belongs: Belongs | None = None, due: float | None = None
) -> Cause | None:
    """
    Explain a line that was printed instead of logged.

    :param belongs: None accepts any printed line, but only if no line of this level was logged
    :param due: expected number of such lines, None for any number
    """
    if belongs is None and run.recording.logs(level=level):
        return None
    # On standard output, the second line of a logged message has no level, as if it were printed.
    logged = {line for one in run.recording.logs() for line in str(one['text']).splitlines()}
    imitated = _imitates_log_lines(run)
    texts = [text for severity, _, text in _on_stdout(run, belongs) if imitated or not severity]
    count = sum(text not in logged for text in texts)
    if not count or (due is not None and abs(count - due) > 1.5):
        return None
    return cause_of('print_instead_of_logger', call=CALLS[level])


def _imitates_log_lines(run: Run) -> bool:
    """Return whether the code contains a text that looks like the beginning of a log line."""
    code = Code(run.files)
    like = any(f'[{name}]' in text for text in code.texts for name in LEVELS.values())
    return like and 'print' in code.calls


def _on_stdout(run: Run, belongs: Belongs | None) -> Iterator[tuple[str, str, str]]:
    """
    Yield level, logger and text of the lines on standard output that may be the missing one.

    Printed text has no level.  If nothing was logged at all, any line may be the missing one.
    """
    for line in str(run.recording.process.get('stdout', '')).splitlines():
        found = _LOGGED.search(line)
        printed = line[: found.start()] if found else line  # text from print(..., end='')
        parts = [('', '', printed)] if printed.strip() else []
        parts += [(found[1], found[2], found[3])] if found else []
        for part in parts:
            if belongs is None or not run.recording.logs() or belongs(part[2]):
                yield part


def why_exception_logged(run: Run, lines: Sequence[Event]) -> Cause | None:
    """Explain the first ERROR line if it contains one of Python's error messages."""
    text = next((str(one['text']) for one in lines if one['level'] == ERROR), '')
    attribute = _ATTRIBUTE.search(text)
    if attribute and redacted(run, attribute[0]) == attribute[0]:
        return exception_cause(Traceback(f'AttributeError: {attribute[0]}', None))
    return why_error_logged(run, text) if _PYTHON.search(text) else None


def why_error_logged(run: Run, text: str) -> Cause:
    """Return a cause that quotes an ERROR line of the node."""
    return cause_of('logged_error', text=redacted(run, text))
