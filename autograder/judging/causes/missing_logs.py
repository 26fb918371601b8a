"""
Explain a missing log line: a different logger, a wrong level, ``print()``, or no line at all.

The lines of a node's logger go to the topic ``/rosout`` and, in this course, also to standard
output.  Other text on standard output was printed, or comes from a different logger.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.code_table import why_by_code
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.logged_errors import why_exception_logged
from autograder.judging.causes.text_table import cause_of
from autograder.recording import Event, LEVELS
from autograder.submission.code.learners_code import Code, leaves_out, logs_with_python
from autograder.submission.code.program import last_name

CALLS = {10: 'debug', 20: 'info', 30: 'warning', 40: 'error', 50: 'fatal'}
Belongs = Callable[[str], bool]
"""Returns whether a text may be the missing line."""

OTHER_LOGGER = cause_of('other_logger')
OF_ROS = ('rcl', 'rmw', 'rcutils')
"""Prefixes of the loggers of ROS libraries, which write only to standard output."""
_LOGGED = re.compile(r'\[(DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[([^\]]*)\]: ?(.*)')


def why_not_logged(
    run: Run, found: Sequence[Event], level: int, belongs: Belongs | None = None
) -> Cause | None:
    """
    Explain a missing log line.

    :param found: lines that were logged instead at that moment
    :param level: level of the missing line
    :param belongs: by default, any line may be the missing one
    """
    if why := why_silent(run) or why_other_logger(run, level, _needed(run, belongs)):
        return why
    instead = [one for one in found if belongs is None or belongs(str(one['text']))]
    if why := why_exception_logged(run, found):
        return why
    if instead:
        other = LEVELS.get(instead[0]['level'], instead[0]['level'])
        why = cause_of('wrong_level', other=other, call=CALLS[level])
        return replace(why, line=instead[0].get('line'))
    return why_printed(run, level, _needed(run, belongs)) or why_dropped(run, level)


def why_elsewhere(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line that is only on standard output, or missing from a silent program."""
    needed = _needed(run, belongs)
    return (
        why_silent(run) or why_other_logger(run, level, needed) or why_printed(run, level, needed)
    )


def _needed(run: Run, belongs: Belongs | None) -> Belongs | None:
    """Return how to recognise the missing line; None (any line) if nothing was logged at all."""
    return belongs if run.recording.logs() else None


def why_other_logger(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """Explain a line at the right level from a logger that does not belong to any node."""
    own = {node.strip('/').replace('/', '.') for node in run.recording.nodes}
    own |= {str(entry['name']) for entry in run.recording.logs()}
    for severity, name, text in _on_stdout(run):
        # Lines of child loggers reach /rosout too, and the libraries of ROS have their own
        # loggers.
        known = name.startswith(OF_ROS) or any(f'{name}.'.startswith(f'{one}.') for one in own)
        if severity == LEVELS[level] and not known and (belongs is None or belongs(text)):
            return OTHER_LOGGER
    if run.recording.logs(level=level) or not logs_with_python(run.files, CALLS[level]):
        return None
    return cause_of('logging', call=CALLS[level])


def why_left_out(run: Run, level: int, found: Sequence[Event] = ()) -> Cause | None:
    """
    Explain missing lines by a logger that is configured to leave some out.

    :param found: lines that were logged; their line numbers identify the call
    """
    lines = {int(one['line']) for one in found if one.get('line')}
    if name := leaves_out(run.files, CALLS[level], lines):
        return cause_of('left_out', name=name, call=CALLS[level])
    for call in Code(run.files).calls.get('set_level', ()):
        named = set(map(last_name, ast.walk(call)))
        if hidden := [one for number, one in LEVELS.items() if number > level and one in named]:
            return cause_of('set_level', level=hidden[0], call=CALLS[level])
    return None


def why_printed(run: Run, level: int, belongs: Belongs | None = None) -> Cause | None:
    """
    Explain a line that was printed instead of logged.

    :param belongs: None accepts any printed line, but only if no line of this level was logged
    """
    if belongs is None and run.recording.logs(level=level):
        return None
    # The second line of a logged message has no level on standard output, but was not printed.
    logged = {line for one in run.recording.logs() for line in str(one['text']).splitlines()}
    for severity, _, text in _on_stdout(run):
        if not severity and text not in logged and (belongs is None or belongs(text)):
            return cause_of('print_instead_of_logger', call=CALLS[level])
    return None


def _on_stdout(run: Run) -> Iterator[tuple[str, str, str]]:
    """Yield level, logger and text of each line on standard output; printed text has no level."""
    for line in str(run.recording.process.get('stdout', '')).splitlines():
        found = _LOGGED.search(line)
        printed = line[: found.start()] if found else line  # print(..., end='') comes first
        if printed.strip():
            yield '', '', printed
        if found:
            yield found[1], found[2], found[3]


def why_dropped(run: Run, level: int) -> Cause | None:
    """Explain a line that was logged at level DEBUG or suppressed by the logger."""
    code = Code(run.files)
    if 'debug' in code.calls and not any(one.calls(CALLS[level]) for one in code.programs):
        return cause_of('debug_level', call=CALLS[level])
    return why_left_out(run, level)


def why_no_line(run: Run, call: str) -> Cause:
    """
    Explain why a running node that answers requests logs nothing.

    :param call: code that creates the node's timer
    """
    return why_by_code('no_line', run, call=call)
