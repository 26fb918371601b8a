"""
What explains the failure of a lifecycle node, of which rclpy itself tells next to nothing.

rclpy swallows the exceptions of transition callbacks: no log line, no traceback.  What is left is
the code, so these functions read it; like everything that explains, they decide no verdict.
"""

from __future__ import annotations

import ast
from dataclasses import replace

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.ended import close_name, why_no_verdict, why_silent
from autograder.judging.causes.unknown_names import homes
from autograder.recording import Recording
from autograder.submission.code.learners_code import Code

_IN_VAIN = 'Failed to trigger lifecycle state machine transition'

READ_ONCE = Cause(
    'read_once',
    'The parameter was changed, and on_configure() still goes by an earlier value.',
    "Read it in on_configure(), each time: self.get_parameter('$parameter').value.",
)
SILENT_REFUSAL = Cause(
    'silent_refusal',
    'A refusal comes without an ERROR line: the reason is not reported.',
    "Each time before FAILURE is returned: self.get_logger().error(f'...') with the limit in it, "
    'without once=.',
)
NO_PARAMETER = Cause(
    'no_parameter',
    'Your node has no parameter called $parameter that takes a float.',
    "In __init__(): self.declare_parameter('$parameter', -1.0).",
)
NO_CONFIGURE = Cause(
    'method_name',
    'There is no method on_configure() in your code; rclpy calls the one of exactly this name.',
    'Write: def on_configure(self, state):',
)
WRONG_DEFAULT = Cause(
    'wrong_default',
    'The limit is not -1.0 before anybody sets it.',
    "In __init__(): self.declare_parameter('$parameter', -1.0).",
)
ERROR_NOT_FAILURE = Cause(
    'error_not_failure',
    'on_configure() returns ERROR, or it raises an exception, which rclpy swallows without a '
    'word.',
    'Return TransitionCallbackReturn.FAILURE. If you do: put the lines before it into try/except '
    'Exception as error, and log error.',
)


def why_ended(run: Run) -> Cause | None:
    """
    Explain a program that is gone or silent.

    A transition that its state does not allow ends the program: that is the consequence of an
    earlier refusal and explains nothing.
    """
    return why_no_verdict(run) or (None if died_in_vain(run) else why_silent(run))


def died_in_vain(run: Run) -> bool:
    """Return whether the program died of a request that its state does not allow."""
    return _IN_VAIN in str(run.recording.process.get('stderr', ''))


def without_its_end(run: Run) -> Run:
    """Return the run without an exception that explains nothing, see :func:`why_ended`."""
    if not died_in_vain(run):
        return run
    events = [
        {**event, 'exit': None, 'stderr': ''} if event['event'] == 'process' else event
        for event in run.recording.events
    ]
    return Run(run.files, Recording(run.recording.header, events), run.facts)


def why_accepted(run: Run, let_through: bool) -> Cause | None:
    """
    Explain a configuration that is not refused, although its limit is not above zero.

    :param let_through: whether it was answered, and with success
    """
    if why := why_no_verdict(run):
        return why
    declared = Code(run.files).calls.get('declare_parameter', ())
    defaults = (call.args[1] for call in declared if len(call.args) > 1)
    values = (one.value for one in defaults if isinstance(one, ast.Constant))
    if any(isinstance(value, (int, float)) and value > 0 for value in values):
        return WRONG_DEFAULT
    if let_through:
        return Cause(
            'let_through',
            'A limit that is not above zero is accepted.',
            'In on_configure(): return FAILURE unless '
            "self.get_parameter('$parameter').value > 0.0.",
        )
    return None


def why_refused(run: Run, name: str, again: bool = False) -> Cause:
    """
    Explain a transition that ended with FAILURE or ERROR.

    :param name: of the transition, such as ``configure``
    :param again: whether it succeeded before
    """
    code = Code(run.files)
    if not code.makes('on_configure'):
        return _why_no_configure(code)
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


def _why_no_configure(code: Code) -> Cause:
    """Explain a node without on_configure(), with the method that is meant to be it."""
    near = close_name('on_configure', code.functions)
    if not near:
        return NO_CONFIGURE
    return replace(
        NO_CONFIGURE,
        text=f'Nobody calls your {near}(); did you mean on_configure()? rclpy calls the method of '
        'exactly this name.',
    )


def why_mute(run: Run) -> Cause:
    """Explain an active node that has its publisher and sends nothing."""
    code = Code(run.files)
    if found := why_ended(run):
        return found
    if 'on_activate' in code.functions and 'on_activate' not in code.calls:
        return Cause(
            'stays_off',
            'Your on_activate() replaces the inherited one, which switches the publishers on.',
            'End it with return super().on_activate(state).',
        )
    if 'publish' in code.calls and 'create_timer' not in code.names:
        return Cause(
            'no_timer',
            'Your code creates no timer, so nothing calls the method that publishes.',
            'In on_configure(): self.create_timer(1.0, self.callback).',
        )
    return Cause(
        'stays_off',
        'The node is active, but its publisher or its timer is not.',
        'Does the timer run, and does its callback publish? Log a line in it. An on_activate() of '
        'your own ends with return super().on_activate(state).',
    )


def why_no_publisher(run: Run, topic: str) -> Cause:
    """
    Explain a lifecycle node that was configured and has no publisher at all.

    :param topic: last part of its name
    """
    code = Code(run.files)
    if not code.makes('on_configure'):
        return _why_no_configure(code)
    return Cause(
        'no_endpoint',
        'Your on_configure() creates no publisher.',
        f"In on_configure(): self.create_lifecycle_publisher($type, '{topic}', 10).",
    )
