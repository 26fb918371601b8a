"""
Why a check failed: the likely cause, from what the probe saw and how the program ended.

What a program printed about itself may name a cause; it never decides a verdict.  When nothing
points anywhere, the answer is None: a misleading cause is worse than none.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
import difflib
import re

from autograder.exam import Cause, Run

_FRAME = re.compile(r'File "[^"]*/(?P<file>[A-Za-z0-9_]+\.py)", line (?P<line>\d+)')
_NO_VERDICT = re.compile(r"'(\w{1,40})' object has no attribute 'to_label'")
_ERROR = re.compile(r'^(?P<type>[A-Za-z_][\w.]*(?:Error|Exception|Interrupt|Exit|Invalid\w*))\b')

PUBLIC = ('Celsius', 'Fahrenheit', 'temp_sensor_01', 'nan', '30')
"""Parts of inputs that every lesson shows; an error that names one gives nothing away."""

RAISED = (
    (
        'InvalidNodeNameException',
        '',
        'invalid_name',
        'A node name has a character that is not allowed, such as a dash or a slash',
        'Use letters, digits and underscores; a namespace is no part of the name.',
    ),
    (
        'TypeError',
        "'NoneType' object is not callable",
        'called_not_passed',
        'A callback is None: the method was called where it should have been passed on',
        'Write the method without parentheses: create_timer(1.0, self.report).',
    ),
    (
        'ValueError',
        'Logger severity cannot be changed',
        'one_level_a_place',
        'One place in the code logs with two levels, and rclpy refuses the second',
        'Write two lines, one for each level, below if and else.',
    ),
    (
        'AttributeError',
        "has no attribute '_default_callback_group'",
        'no_super_init',
        'The class is used before its parent class is ready',
        "Call super().__init__('...') first of all in __init__().",
    ),
)
"""Exceptions of beginners: class, part of the message, cause, its text up to the place, repair."""

BUSY_S = 1.5
"""Processor time [s] that imports and a node's start never reach, four times what they use."""

LIMITS = {
    'wall_time_limit': ('the run took longer than 60 s', 'a loop that never ends or waits'),
    'cpu_limit': ('it used more than 40 s of processor time', 'a loop that never waits'),
    'busy_before_node': (
        'it computes and computes without making a node',
        'a loop that never ends before the node is created',
    ),
    'memory_limit': ('it used more than 1 GiB of memory', 'a list that grows without bound'),
    'output_limit': ('it printed more than 8 MB', 'a print in a loop without a pause'),
    'inode_limit': ('it made more than 20000 files', 'a loop that creates files'),
    'too_much_recorded': ('it sent more than 32 MB', 'a publish in a loop without a pause'),
    'too_many_events': ('it sent thousands of messages', 'a publish in a loop without a pause'),
}


@dataclass(frozen=True)
class Traceback:
    """
    The last exception a program died of.

    :param error: type and message, one line
    :param line: line of the student's file, None if no frame is in it
    """

    error: str
    file: str
    line: int | None

    @property
    def kind(self) -> str:
        """Return the exception's class name."""
        return self.error.partition(':')[0].rpartition('.')[2]


def traceback_of(run: Run) -> Traceback | None:
    """Return the exception at the end of standard error, if the program died of one."""
    text = str(run.recording.process.get('stderr', ''))
    if 'Traceback (most recent call last)' not in text and 'Error' not in text:
        return None
    lines = text.splitlines()
    errors = [line for line in lines if _ERROR.match(line)]
    if not errors:
        return None
    own = {name.rpartition('/')[2] for name in run.files}
    error = _without_secrets(run, errors[-1][:200])
    frames = [match for match in map(_FRAME.search, lines) if match and match['file'] in own]
    if not frames:
        return Traceback(error, '', None)
    return Traceback(error, frames[-1]['file'], int(frames[-1]['line']))


def _without_secrets(run: Run, error: str) -> str:
    """Leave out the message of an exception that shows what a hidden exam has sent."""
    if not run.facts.get('secret'):
        return error
    for event in run.recording.of('input'):
        for value in event['data'].values():
            shown = f'{value:g}' if isinstance(value, float) else str(value)
            if shown not in PUBLIC and (shown in error or str(value) in error):
                return error.partition(':')[0]
    return error


def exception_cause(trace: Traceback) -> Cause:
    """Name what a program died of, with the line of the learner's cell."""
    # Line 1 of the cell is the magic line, so line n of the file is line n + 1 of the cell.
    where = f' in line {trace.line + 1} of the cell' if trace.line else ''
    if trace.kind == 'NotImplementedError':
        return Cause(
            'not_started',
            f'The exercise still raises NotImplementedError{where}.',
            'Replace that line with your own code and run the cell again.',
        )
    if trace.kind in ('SyntaxError', 'IndentationError', 'TabError'):
        return Cause(
            'syntax', f'Python cannot read the file{where}: {trace.error}', 'Mend that line.'
        )
    if trace.kind in ('ModuleNotFoundError', 'ImportError'):
        return Cause(
            'import',
            f'An import fails{where}: {trace.error}',
            'Check the spelling of the package and of the name.',
        )
    for kind, words, name, text, try_this in RAISED:
        if trace.kind == kind and words in trace.error:
            # What is None is found out by the executor, below a line that is innocent.
            at = '' if name == 'called_not_passed' else where
            return Cause(name, f'{text}{at}.', try_this)
    if trace.kind == 'InvalidParameterTypeException':
        # The message shows the value that the grader has set.
        return Cause(
            'parameter_type',
            f'A parameter gets a value of another type than its default has{where}.',
            'Give the default the type of the table: 1.0 is a float, 1 a whole number.',
        )
    if trace.error == 'AssertionError':
        # So rclpy checks the types of some arguments.
        return Cause(
            'assertion',
            f'An assertion fails{where}, and says no more.',
            'Is there a value of a type that does not belong there, such as 0.3 for a Duration?',
        )
    return Cause(
        'exception',
        f'The program stopped with an exception{where}: {trace.error}',
        'Read the last line of the traceback first, then the line of your cell that it names.',
    )


def why_it_ended(run: Run) -> Cause | None:
    """Explain a program that is gone or was ended; empty if it was alive to the end."""
    recording = run.recording
    killed = str(recording.process.get('killed', '')) or recording.end_reason
    if killed == 'no_node' and recording.process.get('cpu_s', 0.0) > BUSY_S:
        killed = 'busy_before_node'  # on a busy machine the clock strikes before the limit
    if killed in LIMITS:
        what, why = LIMITS[killed]
        return Cause(killed, f'The program was ended: {what}.', f'Look for {why}.')
    trace = traceback_of(run)
    if trace is not None and recording.process.get('exit') is not None:
        return exception_cause(trace)
    code = recording.process.get('exit')
    if code == 0 and recording.of('input'):
        return Cause(
            'exited_early',
            f'The program ended by itself after message number {len(recording.of("input"))}.',
            'A node lives until it is stopped: rclpy.spin(node), and no sys.exit() in a callback.',
        )
    if code == 0:
        return Cause(
            'exited_early',
            'The program ended by itself before anything could happen.',
            'Does main() call rclpy.spin(node)? Without it the program runs to its end at once.',
        )
    if code is not None:
        return Cause('died', f'The program died with exit code {code}.', 'Run it in a terminal.')
    return None


def close_name(wanted: str, names: Iterable[str]) -> str:
    """Return the name that looks like a slip of the wanted one, or nothing."""
    found = difflib.get_close_matches(wanted, sorted(set(names)), n=1, cutoff=0.6)
    return found[0] if found else ''


def why_no_node(run: Run, wanted: str) -> Cause:
    """
    Explain why a node was not seen.

    :param wanted: full node name, ``/name``
    """
    others = [name for name in run.recording.nodes if name != wanted]
    near = close_name(wanted, others) or (others[0] if others else '')
    if near:
        return Cause(
            'node_name',
            f'There is a node called {near[1:]}.',
            f"Give super().__init__() the name '{wanted.rpartition('/')[2]}'.",
        )
    return why_it_ended(run) or Cause(
        'no_node',
        'The program runs but never creates a node.',
        'Create your node in main(): rclpy.init(), then the class, then rclpy.spin(node).',
    )


def why_no_endpoint(run: Run, kind: str, topic: str, type_name: str) -> Cause:
    """
    Explain why no endpoint of the right name and type was seen.

    :param kind: ``'publisher'`` or ``'subscription'``
    """
    recording = run.recording
    create = f'create_{kind}'
    for end in recording.endpoints(kind, topic):
        if end['type'] != type_name:
            return Cause(
                'wrong_type',
                f'Your {kind} on {topic} has the type {end["type"]}.',
                f'Pass the class {type_name.rpartition("/")[2]} to {create}().',
            )
    others = [end['topic'] for end in recording.endpoints(kind)]
    near = close_name(topic, others) or next(
        (end['topic'] for end in recording.endpoints(kind) if end['type'] == type_name), ''
    )
    if near and topic.endswith(near):
        return Cause(
            'absolute_name',
            f'Your {kind} uses the absolute name {near}, which stays outside the namespace '
            f'{topic.removesuffix(near)}.',
            f"Give {create}() the name '{near[1:]}', without a slash in front.",
        )
    if near:
        return Cause(
            'topic_name',
            f'Your {kind} uses the topic {near}; did you mean {topic}?',
            f"Give {create}() the name '{_relative(run, topic)}'.",
        )
    other = {'publisher': 'subscription', 'subscription': 'publisher'}[kind]
    if recording.endpoints(other, topic):
        return Cause(
            'wrong_direction',
            f'Your node has a {other} on {topic}, not a {kind}.',
            f'Use {create}().',
        )
    ended = why_it_ended(run)
    if ended:
        return ended
    if not recording.nodes:
        return why_no_node(run, '/?')
    return Cause(
        'no_endpoint', f'Your node creates no {kind}.', f'Call self.{create}() in __init__().'
    )


def _relative(run: Run, topic: str) -> str:
    """Return the name that the code gives a topic; the node's namespace is put before it."""
    homes = [name.rpartition('/')[0] + '/' for name in run.recording.nodes]
    return topic.removeprefix(max((home for home in homes if topic.startswith(home)), default='/'))


def why_no_verdict(run: Run) -> Cause | None:
    """Explain a lifecycle node that died because a transition callback returned something else."""
    found = _NO_VERDICT.search(str(run.recording.process.get('stderr', '')))
    if found is None:
        return None
    if found[1] == 'NoneType':
        return Cause(
            'no_return',
            'A transition callback ends without return, so rclpy does not know how it went.',
            'End each on_...() with return super().on_...(state), or with a '
            'TransitionCallbackReturn.',
        )
    return Cause(
        'wrong_return',
        f'A transition callback returns a {found[1]}, which rclpy does not understand.',
        'Return a TransitionCallbackReturn, or what super().on_...(state) returns.',
    )


def why_silent(run: Run) -> Cause | None:
    """Explain a node whose endpoints are right and from which nothing comes."""
    ended = why_it_ended(run)
    if ended:
        return ended
    if run.recording.end_reason == 'unresponsive':
        return Cause(
            'blocked',
            'A callback of your node does not come to an end.',
            'A callback must return: use a timer instead of a loop or time.sleep().',
        )
    barriers = run.recording.of('barrier')
    if barriers and not any(event['answered'] for event in barriers):
        return Cause(
            'never_spun',
            'Your node exists but nobody spins it, so no callback ever runs.',
            'Call rclpy.spin(node) in main(), with the node that you created.',
        )
    return None
