"""
Why a log line that is due did not come: another logger, another level, ``print()``, or none.

A node's own lines go to the topic ``/rosout`` and, as the course sets it up, to standard output
too.  Any other text on standard output was printed, or comes from a different logger.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.code_table import why_by_code
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.logged_errors import why_exception_logged
from autograder.judging.causes.text_table import cause_of
from autograder.recording import Event, LEVELS
from autograder.submission.code.code_places import leaves_out, logs_with_python
from autograder.submission.code.learners_code import Code, in_cell, last_name

CALLS = {10: 'debug', 20: 'info', 30: 'warning', 40: 'error', 50: 'fatal'}
Belongs = Callable[[str], bool]
"""Returns whether a text is that of the missing line."""

OTHER_LOGGER = cause_of('other_logger')
OF_ROS = ('rcl', 'rmw', 'rcutils')
"""How the names of loggers begin that the libraries of ROS write with, on standard output only."""
_LOGGED = re.compile(r'\[(DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[([^\]]*)\]: ?(.*)')


def why_not_logged(
    run: Run, found: Sequence[Event], level: int, belongs: Belongs | None = None
) -> Cause | None:
    """
    Explain a log line that did not come.

    :param found: what was logged instead at that moment
    :param level: the level that is missing
    :param belongs: without it, any line may be the missing one
    """
    if why := why_silent(run) or why_other_logger(run, level, _needed(run, belongs)):
        return why
    instead = [one for one in found if belongs is None or belongs(str(one['text']))]
    if why := why_exception_logged(run, found):
        return why
    if instead:
        other = LEVELS.get(instead[0]['level'], instead[0]['level'])
        return cause_of('wrong_level', other=other, call=CALLS[level])
    return why_printed(run, level, _needed(run, belongs)) or why_dropped(run, level)


def why_elsewhere(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line that comes on standard output only, or not at all because all is silent."""
    needed = _needed(run, belongs)
    return (
        why_silent(run) or why_other_logger(run, level, needed) or why_printed(run, level, needed)
    )


def _needed(run: Run, belongs: Belongs | None) -> Belongs | None:
    """Return how to know the missing line; where nothing is logged at all, it is any."""
    return belongs if run.recording.logs() else None


def why_other_logger(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line of the right level that comes from a logger that belongs to no node."""
    own = {node.strip('/').replace('/', '.') for node in run.recording.nodes}
    own |= {str(entry['name']) for entry in run.recording.logs()}
    for severity, name, text in _on_stdout(run):
        # A child's lines reach /rosout as its parent's do; and ROS has words of its own.
        known = name.startswith(OF_ROS) or any(f'{name}.'.startswith(f'{one}.') for one in own)
        if severity == LEVELS[level] and not known and (belongs is None or belongs(text)):
            return OTHER_LOGGER
    if run.recording.logs(level=level) or not logs_with_python(run.files, _names(level)):
        return None
    return cause_of('logging', call=CALLS[level])


def why_left_out(run: Run, level: int, found: Sequence[Event] = ()) -> Cause | None:
    """
    Explain lines that are missing because the logger is told to leave some out.

    :param found: those that came; where they were logged tells which call it is
    """
    lines = {int(one['line']) for one in found if one.get('line')}
    if name := leaves_out(run.files, _names(level), lines):
        return cause_of('left_out', name=name, call=CALLS[level])
    for call in Code(run.files).calls.get('set_level', ()):
        named = set(map(last_name, ast.walk(call)))
        if hidden := [one for number, one in LEVELS.items() if number > level and one in named]:
            place = in_cell(call.lineno)
            return cause_of('set_level', place=place, level=hidden[0], call=CALLS[level])
    return None


def _names(level: int) -> Sequence[str]:
    """Return what the functions are called that log at a level."""
    return (CALLS[level], 'warn') if CALLS[level] == 'warning' else (CALLS[level],)


def why_printed(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line that is printed; any counts only if there is none of that level at all."""
    if belongs is None and run.recording.logs(level=level):
        return None
    # The second line of a log text has no level in front of it either.
    logged = {line for one in run.recording.logs() for line in str(one['text']).splitlines()}
    for severity, _, text in _on_stdout(run):
        if not severity and text not in logged and (belongs is None or belongs(text)):
            return cause_of('print_instead_of_logger', call=CALLS[level])
    return None


def _on_stdout(run: Run) -> Iterator[tuple[str, str, str]]:
    """Yield level, logger and text of what is on standard output; print() has no level."""
    for line in str(run.recording.process.get('stdout', '')).splitlines():
        found = _LOGGED.search(line)
        printed = line[: found.start()] if found else line  # print(..., end='') comes before it
        if printed.strip():
            yield '', '', printed
        if found:
            yield found[1], found[2], found[3]


def why_dropped(run: Run, level: int) -> Cause | None:
    """Explain a line at level DEBUG with none of the right one, or one that is left out."""
    code = Code(run.files)
    if 'debug' in code.calls and not code.calls.keys() & set(_names(level)):
        return cause_of('debug_level', call=CALLS[level])
    return why_left_out(run, level)


def why_no_line(run: Run, call: str) -> Cause:
    """
    Explain a node that is served, lives on and logs nothing.

    :param call: how its timer is made
    """
    return why_by_code('no_line', run, call=call)
