"""
What explains the failure of a lifecycle node, of which rclpy itself tells next to nothing.

rclpy swallows the exceptions of transition callbacks: no log line, no traceback.  What is left is
the code, so these functions read it; like everything that explains, they decide no verdict.
"""

from __future__ import annotations

import ast

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.ended import why_no_configure, why_no_verdict
from autograder.judging.causes.unknown_names import homes
from autograder.submission.code.learners_code import Code

READ_ONCE = Cause(
    'read_once',
    'The parameter has changed, but on_configure() still uses an earlier value.',
    "Read it in on_configure(), each time: self.get_parameter('$parameter').value.",
)
SILENT_REFUSAL = Cause(
    'silent_refusal',
    'Your node refuses without an ERROR line.',
    "Each time before FAILURE is returned: self.get_logger().error(f'...') with the limit in it, "
    'without once=.',
)
NO_PARAMETER = Cause(
    'no_parameter',
    'Your node has no parameter called $parameter that takes a float.',
    "In __init__(): self.declare_parameter('$parameter', -1.0).",
)
WRONG_DEFAULT = Cause(
    'wrong_default',
    'The default of the limit is not -1.0.',
    "In __init__(): self.declare_parameter('$parameter', -1.0).",
)
LET_THROUGH = Cause(
    'let_through',
    'Your node accepts a limit that is not above zero.',
    "In on_configure(): return FAILURE unless self.get_parameter('$parameter').value > 0.0.",
)
ERROR_NOT_FAILURE = Cause(
    'error_not_failure',
    'on_configure() returns ERROR, or it raises an exception, which rclpy swallows without a '
    'word.',
    'Return TransitionCallbackReturn.FAILURE. If you do: put the lines before it into try/except '
    'Exception as error, and log error.',
)


def why_accepted(run: Run) -> Cause:
    """Explain a configuration that succeeds, although its limit is not above zero."""
    if why := why_no_verdict(run):
        return why
    declared = Code(run.files).calls.get('declare_parameter', ())
    defaults = (call.args[1] for call in declared if len(call.args) > 1)
    values = (one.value for one in defaults if isinstance(one, ast.Constant))
    if any(isinstance(value, (int, float)) and value > 0 for value in values):
        return WRONG_DEFAULT
    return LET_THROUGH


def why_refused(run: Run, name: str, again: bool = False) -> Cause:
    """
    Explain a transition that ended with FAILURE or ERROR.

    :param name: of the transition, such as ``configure``
    :param again: whether it succeeded before
    """
    code = Code(run.files)
    if why := why_no_configure(code):
        return why
    if again:
        return Cause(
            'refused_again',
            f'The first time, on_{name}() succeeds, and the second time it does not.',
            'Something is not set back in between, as in on_deactivate() or on_cleanup().',
        )
    taken = code.parameters(f'on_{name}')
    if taken is not None and len(taken) < 2:
        return Cause(
            'callback_arguments',
            f'rclpy calls on_{name}() with the state it comes from, and yours takes none: an '
            'exception, which rclpy swallows without a word.',
            f'Write def on_{name}({(*taken, "self")[0]}, state):',
        )
    known = {one: home for home, names in homes().items() for one in names.split()}
    missing = next((one for one in known if one in code.unmade), '')
    if missing:
        return Cause(
            'missing_import',
            f'{missing} is used and not imported; rclpy swallows the NameError of on_{name}() '
            'without a word.',
            f'Write at the top: from {known[missing]} import {missing}',
        )
    return Cause(
        'refused',
        f'on_{name}() returns FAILURE or ERROR, or it raises an exception, which rclpy '
        'swallows without a word.',
        f'Put the lines of on_{name}() into try/except Exception as error, and log error.',
    )
