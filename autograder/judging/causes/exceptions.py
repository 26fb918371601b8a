"""
Explain the exception that ended a program: what it means, where it is, and what to do.

Python's message says what happened; beginners need to know which of their mistakes caused it.  The
table ``by_exception.txt`` explains exceptions that a pattern recognises, and :mod:`.unknown_names`
explains unknown names.  This module handles exceptions for which the code must be read too.
"""

from collections.abc import Mapping
from dataclasses import replace
import re

from autograder.exam.exam import Cause
from autograder.exam.words import rows
from autograder.judging.causes.text_table import cause_of, FOLDER, rows_of
from autograder.judging.causes.tracebacks import Traceback
from autograder.judging.causes.unknown_names import (
    homes,
    import_cause,
    init_cause,
    name_cause,
)
from autograder.layout import Layout

_ARGUMENTS = re.compile(
    r'(?P<callee>[\w.<>]{1,120})\(\) (?P<said>takes .*given|(?P<missing>missing) .*|'
    r"got an unexpected keyword argument '\w{1,60}')"
)
_FIELD = re.compile(r"The '(\w{1,60})' field must be ([^:]{1,80})")
_ATTRIBUTE = re.compile(r"^AttributeError: '([A-Z]\w{0,40})' object has no attribute '([a-z]\w*)")
_MESSAGE_IMPORT = re.compile(r'\bfrom[ \t]+(\w+)\.msg[ \t]+import[ \t]+(\([^)]{0,999}\)|[^\n#]+)')
_SUBSCRIPTION = re.compile(
    r'create_subscription\(\s*(?:msg_type=)?(\w{1,60})\s*,[^,]{1,80},\s*'
    r'(?:callback=)?(?:\w{1,60}\.)?(\w{1,60})'
)
_HOLDS_MORE = ('Header', 'ColorRGBA', 'Empty')

MOST_SUBSCRIPTIONS = 20
"""Maximum number of subscriptions that are examined."""

BY_NAME = {'QoSProfile': 'QoSProfile(depth=10)', 'Duration': 'Duration(seconds=0.3)'}
"""Classes of rclpy that accept only keyword arguments."""

SIGNATURES = dict(rows((FOLDER / 'of_calls.txt').read_text(encoding='utf-8')))
"""Advice on calls of rclpy's functions, by name."""
WANTED = rows((FOLDER / 'of_values.txt').read_text(encoding='utf-8'))
"""Patterns for rclpy's message about a value, with advice."""


def exception_cause(trace: Traceback) -> Cause:
    """Return the cause of an exception."""
    cause = next(filter(None, (explain(trace) for explain in _IN_ORDER)))
    elsewhere = cause.act or cause.cause_id in _IN_A_FILE
    return replace(cause, line=cause.line or (None if elsewhere else trace.place))


def _known_cause(trace: Traceback) -> Cause | None:
    """Explain an exception that is in the table."""
    for row in rows_of('by_exception.txt'):
        if found := re.search(row.when, trace.said):
            # If the pattern includes the line of code, name that line even if it only spins.
            line = trace.line if r'\n' in row.when else None
            text, repair = found.expand(row.text), found.expand(row.try_this)
            return Cause(row.cause_id, text, repair, line=line)
    return None


def _attribute_cause(trace: Traceback) -> Cause | None:
    """Explain an attribute that does not exist."""
    if 'has no attribute' not in trace.error:
        return None
    return cause_of('no_attribute', error=trace.error)


def _arguments_cause(trace: Traceback) -> Cause | None:
    """Explain a call with too many, too few or unknown arguments."""
    found = _ARGUMENTS.search(trace.error)
    if trace.kind != 'TypeError' or found is None:
        return None
    owner, name = ['', *found['callee'].split('.')][-2:]
    made, said = name == '__init__', found['said']
    called = owner if made else name
    own = called in trace.own and (made or owner in ('', '<locals>', *trace.own))
    if made and not own and (cause := _by_name_cause(owner, said, trace)):
        return cause
    # Test whether the line passes on the result of the call.
    call = rf'(?:self\.)?{re.escape(name)}\(\)'
    passed = re.search(rf'[(,=]\s*{call}|^{call}\s*[,)]', trace.bare_code)
    if own and passed and found['missing']:
        return cause_of('called_not_passed', method=name)
    if trace.spun and not made:
        callback = 'A callback' if name == '<lambda>' else f'{name}()'
        return cause_of('callback_called', callback=callback, about=[name])
    advice = SIGNATURES.get(name, f'Look up how the lesson calls {called}().')
    if own:
        advice = f'Compare the call with its line def {name}(...); Python passes self itself.'
    return Cause('arguments', f'{called}() is called wrongly: {said}.', advice)


def _by_name_cause(name: str, said: str, trace: Traceback) -> Cause | None:
    """Explain a message or an rclpy object that is created with wrong arguments."""
    package = _messages(trace).get(name, '')
    field = _main_field(name, package) if package else ''
    example = f'{name}({field or "field"}=...)' if package else BY_NAME.get(name, '')
    if not example:
        return None
    text = f'{name}() takes only keyword arguments, but gets a value without a name.'
    if said.startswith('got'):
        text = f'{name}() has no argument with that name: {said}.'
    fields = f' {_show(name, package)}' if package and not field else ''
    return Cause('by_name', text, f'Write the name before the value: {example}.{fields}')


def _messages(trace: Traceback) -> Mapping[str, str]:
    """Return the package of each message type that the lessons know or the code imports."""
    known = {
        name: home.removesuffix('.msg')
        for name, home in homes(trace.names).items()
        if home.endswith('.msg')
    }
    for package, names in _MESSAGE_IMPORT.findall(trace.bare):
        known |= dict.fromkeys(re.findall(r'\w+', names), package)
    return {name: package for name, package in known.items() if name not in trace.own}


def _main_field(name: str, package: str) -> str:
    """Return the main field of a message type, empty if there are several."""
    if package == 'std_msgs' and name not in _HOLDS_MORE and not name.endswith('Array'):
        return 'data'
    if (package, name) == ('builtin_interfaces', 'Time'):
        return 'sec'
    return Layout.here().facts.messages.get(f'{package}/msg/{name}', '')


def _heard(trace: Traceback) -> Mapping[str, str]:
    """Return the names of received messages in the line that failed, with their types."""
    heard = {}
    for kind, callback in _SUBSCRIPTION.findall(trace.bare)[:MOST_SUBSCRIPTIONS]:
        taken = re.search(rf'def {callback}\(\s*(?:self\s*,\s*)?(\w+)', trace.bare)
        if taken and re.search(rf'\b{taken[1]}\b', trace.bare_code):
            heard[taken[1]] = kind
    return heard


def _show(name: str, package: str) -> str:
    return f'ros2 interface show {package}/msg/{name} lists the fields.'


def _field_cause(trace: Traceback) -> Cause | None:
    """Explain a value of the wrong type for a field of a message."""
    found = _FIELD.search(trace.error)
    if found is None:
        return None
    name, wanted = found[1], found[2].partition(' and each')[0].strip()
    text = f'The field {name} gets a value that does not fit: it must be {wanted}.'
    given = re.search(rf'\b{name}\s*=\s*(\w+)\s*(?:[,)]|$)', trace.bare_code)
    kind = _heard(trace).get(given[1], '') if given else ''
    field = _main_field(kind, _messages(trace).get(kind, ''))
    matches = ((re.search(says, trace.error), advice) for says, advice in WANTED)
    advice = next(match.expand(advice) for match, advice in matches if match)
    if given and field and 'sub message' not in wanted:
        advice = f'{given[1]} is the whole message: use {given[1]}.{field}.'
    return Cause('stamp_value' if '.to_msg()' in advice else 'field_value', text, advice)


def _no_field_cause(trace: Traceback) -> Cause | None:
    """Explain the use of a field that a message does not have, in its constructor or elsewhere."""
    known = _messages(trace)
    if 'Invalid arguments passed to constructor' in trace.error:
        named = re.findall(r'\b([A-Z]\w{0,40})\(', trace.bare_code)
        made = next((name for name in named if name in known), '')
        text = f'Your code sets a field that {made or "the message"} does not have.'
        advice = "ros2 interface show with the type's name lists the fields."
        return Cause('no_field', text, _show(made, known[made]) if made else advice)
    found = _ATTRIBUTE.match(trace.error)
    if found is None or found[1] not in known:
        return None
    if found[1] == 'String' and hasattr(str, found[2]):
        return _take_the_field('String', trace)
    text = f'The type {found[1]} has no field {found[2]}.'
    return Cause('no_field', text, _show(found[1], known[found[1]]))


def _whole_message_cause(trace: Traceback) -> Cause | None:
    """Explain code that uses a message as if it were a number or a string."""
    if trace.kind != 'TypeError' or 'not callable' in trace.error:
        return None
    known = _messages(trace)
    named = [name for name in re.findall(r'\b[A-Z]\w*', trace.error) if name in known]
    return _take_the_field(named[0], trace) if named else None


def _take_the_field(kind: str, trace: Traceback) -> Cause:
    """Return the cause that recommends a field of the message instead of the whole message."""
    package = _messages(trace)[kind]
    field = _main_field(kind, package)
    name = next((one for one, theirs in _heard(trace).items() if theirs == kind), 'message')
    if field:
        return cause_of('whole_message', kind=kind, value=name, field=field)
    return cause_of('several_fields', kind=kind, show=_show(kind, package))


def _other_cause(trace: Traceback) -> Cause:
    """Explain how to find the reason for an exception, because feedback shows no traceback."""
    code = trace.code[:100]
    if trace.spun or not code:
        situation = 'exception_elsewhere'
    elif re.search(r'^[ \t]+raise[ \t]*$', trace.bare, re.MULTILINE):
        # The traceback ends where the exception was first raised, which may be right.
        return cause_of('exception_raised_again', error=trace.error, act='raised_again')
    else:
        situation = 'own_exception' if code.startswith('raise') else 'exception'
    return cause_of(situation, error=trace.error, code=code)


_IN_A_FILE = ('no_parameter_file', 'parameter_file')
"""Causes that are not in the line that raises the exception."""
_IN_ORDER = (
    init_cause,
    _known_cause,
    _arguments_cause,
    import_cause,
    name_cause,
    _field_cause,
    _no_field_cause,
    _whole_message_cause,
    _attribute_cause,
    _other_cause,
)
