"""
The exception a program died of, in the learner's words: what it means, where, and what to do.

Python's own message says what happened; beginners need to hear which of their habits leads there.
The texts that are matched are those of Python and rclpy; lesson 08 makes each of them happen.
"""

from __future__ import annotations

from dataclasses import dataclass
import re

from autograder.judging.exam import Cause, Run

_FRAME = re.compile(r'File "[^"]*/(?P<file>[A-Za-z0-9_]+\.py)", line (?P<line>\d+)')
_ERROR = re.compile(r'^(?P<type>[A-Za-z_][\w.]*(?:Error|Exception|Interrupt|Exit|Invalid\w*))\b')
_ARGUMENTS = re.compile(
    r'callback should be either be callable|'
    r'(?P<name>[\w.]{1,90})\(\) (?:takes (?:from \d+ to )?\d+ positional arguments? but \d+ '
    r'w(?:as|ere) given|(?P<missing>missing) \d+ required positional)'
)
_NAME = re.compile(r"name '(\w{1,60})' is not defined")

PUBLIC = ('Celsius', 'Fahrenheit', 'temp_sensor_01', 'nan', '30')
"""Parts of inputs that every lesson shows; an error that names one gives nothing away."""

HOMES = {
    'rclpy.node': 'Node',
    'rclpy.lifecycle': 'LifecycleNode TransitionCallbackReturn',
    'rclpy.executors': 'SingleThreadedExecutor MultiThreadedExecutor ExternalShutdownException',
    'rclpy.qos': 'QoSProfile ReliabilityPolicy DurabilityPolicy HistoryPolicy LivelinessPolicy',
    'rclpy.duration': 'Duration',
    'rclpy.event_handler': 'SubscriptionEventCallbacks PublisherEventCallbacks',
    'std_msgs.msg': 'String Float64 Float32 Int32 Bool',
    'temp_monitor_pkg.msg': 'Temperature Num',
}
"""Where the names of the lessons come from."""
MODULES = ('rclpy', 'math', 'random', 'time')


@dataclass(frozen=True)
class Kind:
    """
    One way in which an exception is raised by a beginner.

    :param kind: name of its class; empty for any
    :param says: regular expression of its message, searched
    :param text: what is wrong; the place is put behind it
    :param placed: whether the line of the traceback is the one to mend
    """

    kind: str
    says: str
    cause_id: str
    text: str
    try_this: str
    placed: bool = True


KINDS = (
    Kind(
        'InvalidNodeNameException',
        '',
        'invalid_name',
        'A node name has a character that is not allowed, such as a dash or a slash',
        'Use letters, digits and underscores; a namespace is no part of the name.',
    ),
    Kind(
        'InvalidTopicNameException',
        '',
        'invalid_topic',
        'A topic name has a character that is not allowed, such as a space or a dash',
        'Use letters, digits and underscores, no digit in front, and no slash at the end.',
    ),
    Kind(
        'TypeError',
        "'NoneType' object is not callable",
        'called_not_passed',
        'A callback is None: the method was called where it should have been passed on',
        'Write the method without parentheses: create_timer(1.0, self.report).',
        placed=False,  # it is found out by the executor, below a line that is innocent
    ),
    Kind(
        'TypeError',
        r'RcutilsLogger\.\w+\(\) takes',
        'log_arguments',
        'The logger takes one text, and gets several values',
        "Put them into one f-string: info(f'{value:.2f} degrees').",
    ),
    Kind(
        'ValueError',
        'Logger severity cannot be changed',
        'one_level_a_place',
        'One place in the code logs with two levels, and rclpy refuses the second',
        'Write two lines, one for each level, below if and else.',
    ),
    Kind(
        '',
        "has no attribute '_default_callback_group'|argument: 'node_name'",
        'no_super_init',
        'The class is used before its parent class is ready',
        "Call super().__init__('...') first of all in __init__().",
    ),
    Kind(
        'AttributeError',
        r"property '\w+' of '\w+' object has no setter",
        'reserved_name',
        'Every node already has something of that name',
        'Choose another name for your attribute, such as self.my_publisher.',
    ),
    Kind(
        'AttributeError',
        "has no attribute '_TYPE_SUPPORT'|'_CREATE_TYPE_SUPPORT'",
        'not_a_type',
        'What is given as the message type is no message class',
        "Import the class and pass it: create_publisher(String, 'chatter', 10).",
    ),
    Kind(
        'NotInitializedException',
        '',
        'no_init',
        'A node is made before ROS is ready',
        'Call rclpy.init(args=args) first of all in main().',
    ),
    Kind(
        'RuntimeError',
        r'Context\.init\(\) must only be called once',
        'init_twice',
        'rclpy.init() is called a second time',
        'Call it once, in main(), and not in the class.',
    ),
    Kind(
        'InvalidHandle',
        '',
        'destroyed_early',
        'Something is used after it was destroyed',
        'Call destroy_node() once, at the very end, in finally; destroy nothing that is still '
        'used.',
        placed=False,
    ),
    Kind(
        '',
        'generator already executing|Executor is already spinning',
        'nested_spin',
        'A callback spins the node that is being spun for it',
        'Never spin in a callback: return from it, and the next message finds the next call.',
    ),
    Kind(
        'ParameterNotDeclaredException',
        '',
        'not_declared',
        'A parameter is read that the node has not declared under that name',
        "Call self.declare_parameter('limit', -1.0) in __init__(), with the same spelling.",
    ),
    Kind(
        'InvalidParameterTypeException',  # its message shows the value that the grader has set
        '',
        'parameter_type',
        'A parameter gets a value of another type than its default has',
        'Give the default the type of the table: 1.0 is a float, 1 a whole number.',
    ),
    Kind(
        'InvalidQoSProfileException',
        '',
        'no_depth',
        'A QoSProfile is made without a depth',
        'Say how many messages it keeps: QoSProfile(depth=10).',
    ),
    Kind(
        'TypeError',
        "cannot pickle 'rclpy",
        'deep_copy',
        'An object of ROS is copied with deepcopy(), which it does not allow',
        'Use copy.copy(), or make one of your own, such as QoSProfile(depth=10).',
    ),
    Kind(
        'TypeError',
        r"Expected <class '[\w.]+'>, got <class",
        'not_a_message',
        "publish() gets something that is no message of the publisher's type",
        "Put the value into a message: publish(String(data='hello')).",
    ),
)
"""Exceptions of beginners, the first that fits."""

FIELD = re.compile(r"The '(\w{1,60})' field must be ([^:]{1,80})")
MESSAGE_FIELD = re.compile(
    r"^AttributeError: '([A-Z]\w{0,40})' object has no attribute '(\w{1,60})'"
)
CALLED = re.compile(r'\b([A-Z]\w{0,40})\(')


@dataclass(frozen=True)
class Traceback:
    """
    The last exception a program died of.

    :param error: type and message, one line
    :param line: line of the student's file, None if no frame is in it
    :param code: text of that line
    :param own: classes that the student's files define
    """

    error: str
    file: str
    line: int | None
    code: str = ''
    own: frozenset[str] = frozenset()

    @property
    def kind(self) -> str:
        """Return the exception's class name."""
        return self.error.partition(':')[0].rpartition('.')[2]

    @property
    def where(self) -> str:
        """Return the place in the learner's cell, to be put behind a sentence."""
        # What is found out below the line that spins is to be mended elsewhere.
        if not self.line or 'spin' in self.code:
            return ''
        # Line 1 of the cell is the magic line, so line n of the file is line n + 1 of the cell.
        return f' in line {self.line + 1} of the cell'


def traceback_of(run: Run) -> Traceback | None:
    """Return the exception at the end of standard error, if the program died of one."""
    text = str(run.recording.process.get('stderr', ''))
    if 'Traceback (most recent call last)' not in text and 'Error' not in text:
        return None
    lines = text.splitlines()
    errors = [line for line in lines if _ERROR.match(line)]
    if not errors:
        return None
    error = _without_secrets(run, errors[-1][:200])
    texts = {name.rpartition('/')[2]: text for name, text in run.files.items()}
    own = frozenset(re.findall(r'^class (\w+)', '\n'.join(texts.values()), re.MULTILINE))
    frames = [match for match in map(_FRAME.search, lines) if match and match['file'] in texts]
    if not frames:
        return Traceback(error, '', None, own=own)
    file, line = frames[-1]['file'], int(frames[-1]['line'])
    code = texts[file].splitlines()[line - 1 : line]
    return Traceback(error, file, line, code[0].strip() if code else '', own)


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
    if trace.kind == 'NotImplementedError':
        return Cause(
            'not_started',
            f'The exercise still raises NotImplementedError{trace.where}.',
            'Replace that line with your own code and run the cell again.',
        )
    if trace.error == 'AssertionError':
        # So rclpy checks the types of some arguments.
        return Cause(
            'assertion',
            f'An assertion fails{trace.where}, and says no more.',
            'Is there a value of a type that does not belong there, such as 0.3 for a Duration?',
        )
    for kind in KINDS:
        if kind.kind in ('', trace.kind) and re.search(kind.says, trace.error):
            place = trace.where if kind.placed else ''
            return Cause(kind.cause_id, f'{kind.text}{place}.', kind.try_this)
    return (
        _arguments_cause(trace)
        or _unreadable(trace)
        or _import_cause(trace)
        or _name_cause(trace)
        or _field_cause(trace)
        or _any_cause(trace)
    )


def _any_cause(trace: Traceback) -> Cause:
    if trace.kind == 'AttributeError' and 'has no attribute' in trace.error:
        return Cause(
            'no_attribute',
            f'Something is used{trace.where} that is not there: {trace.error}',
            'Is it spelled as where it is made, and made before it is used? self.name = ... '
            'belongs into __init__().',
        )
    return Cause(
        'exception',
        f'The program stopped with an exception{trace.where}: {trace.error}',
        'Read the last line of the traceback first, then the line of your cell that it names.',
    )


def _arguments_cause(trace: Traceback) -> Cause | None:
    """Explain a function that gets another number of arguments than it takes."""
    found = _ARGUMENTS.search(trace.error)
    if trace.kind not in ('TypeError', 'RuntimeError') or found is None:
        return None
    name = (found['name'] or '').rpartition('.')[2][:60]
    if found['missing'] and name in ('create_publisher', 'create_subscription'):
        return Cause(
            'no_depth',
            f'{name}() gets too few arguments{trace.where}: {trace.error.partition(": ")[2]}',
            "create_publisher(String, 'chatter', 10): type, name, and the depth of the queue; a "
            'subscription takes its callback before the depth.',
        )
    if name and found['missing'] and f'.{name}()' in trace.code:
        return Cause(
            'called_not_passed',
            f'{name}() is called{trace.where}, where it should be passed on.',
            f'Write the method without parentheses: self.{name}.',
        )
    return Cause(
        'callback_arguments',
        f'{name or "A callback"}() gets another number of arguments than its def line has'
        f'{trace.where}.',
        'A subscription hands over the message, an event callback gets the event, a timer gives '
        'nothing; and a method has self first: def take(self, message).',
    )


def _unreadable(trace: Traceback) -> Cause | None:
    """Explain a file that Python cannot read."""
    if trace.kind in ('IndentationError', 'TabError'):
        return Cause(
            'indentation',
            f'The spaces at the beginning of a line are not right{trace.where}: {trace.error}',
            'Indent by four spaces a level: what belongs to a def, an if or a class stands '
            'further right than it.',
        )
    if trace.kind == 'SyntaxError':
        return Cause(
            'syntax',
            f'Python cannot read the file{trace.where}: {trace.error}',
            'Mend that line; often a bracket, a colon or a quote is missing in the line above.',
        )
    return None


def _import_cause(trace: Traceback) -> Cause | None:
    """Explain an import that fails."""
    if trace.kind not in ('ModuleNotFoundError', 'ImportError'):
        return None
    package = re.search(
        r"No module named '(\w+(?:_interfaces|_msgs|_pkg|\.msg\b)\w*)", trace.error
    )
    if package:
        return Cause(
            'message_not_built',
            f'There is no message package of that name{trace.where}: {trace.error}',
            'Is it the package of the table, spelled as there? One of your own has to be built '
            'first: build_messages().',
        )
    return Cause(
        'import',
        f'An import fails{trace.where}: {trace.error.partition(" (")[0]}',
        'Check the spelling of the package and of the name.',
    )


def _name_cause(trace: Traceback) -> Cause | None:
    """Explain a name that nobody has defined."""
    found = _NAME.search(trace.error)
    if trace.kind != 'NameError' or found is None:
        return None
    name = found[1]
    home = next((home for home, names in HOMES.items() if name in names.split()), '')
    if home or name in MODULES:
        line = f'from {home} import {name}' if home else f'import {name}'
        return Cause(
            'missing_import',
            f'The name {name} is used{trace.where} and never imported.',
            f'Write at the top of the cell: {line}',
        )
    advice = 'Is it spelled as where it is made? What belongs to the node is self.name.'
    if name == 'self':
        advice = 'Only a method has it, as its first argument, and further right than its def.'
    return Cause(
        'unknown_name', f'The name {name} is used{trace.where} and was never made.', advice
    )


def _field_cause(trace: Traceback) -> Cause | None:
    """Explain a field of a message that is not there, or gets a value of another type."""
    typed = FIELD.search(trace.error)
    if typed:
        return Cause(
            'field_value',
            f'The field {typed[1]} gets a value of another type{trace.where}: '
            f'it must be {typed[2].strip()}.',
            'A number is no text, and 25 is no float: write 25.0, or float(value).',
        )
    homes = {
        name: home.removesuffix('.msg')
        for home, names in HOMES.items()
        if home.endswith('.msg')
        for name in names.split()
    }
    known = homes.keys() - trace.own
    if 'Invalid arguments passed to constructor' in trace.error:
        made = [name for name in CALLED.findall(trace.code) if name in known]
        name, shown = 'message', "with the type's name"
        if made:
            name, shown = made[0], f'{homes[made[0]]}/msg/{made[0]}'
        return Cause(
            'no_field',
            f'A {name} is made with a field that it does not have{trace.where}.',
            f'ros2 interface show {shown} lists the fields.',
        )
    found = MESSAGE_FIELD.match(trace.error)
    # No field begins with an underscore: rclpy took the message for something else.
    if found and found[1] in known and not found[2].startswith('_'):
        return Cause(
            'no_field',
            f'A {found[1]} has no field {found[2]}, which is used{trace.where}.',
            f'ros2 interface show {homes[found[1]]}/msg/{found[1]} lists the fields.',
        )
    return None
