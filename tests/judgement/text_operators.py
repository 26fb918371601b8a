"""
Make single changes to the non-Python files of a package, and to the letters of a quiz.

As in :mod:`tests.judgement.operators`, each change is one slip: in a line, a type, a name, a
bound, a tag or a command.
"""

from collections.abc import Callable, Iterator
import re

from tests.judgement.operators import Change, slip

OTHER_TYPE = {
    'float64': 'float32',
    'string': 'wstring',
    'uint8': 'int8',
    'builtin_interfaces/Time': 'builtin_interfaces.Time',
    'string<=12': 'string',
    'float32[3]': 'float32[]',
    'uint8[<=8]': 'uint8[8]',
}
_CONSTANT = re.compile(r'(\w+) +(\w+)=(-?\w+)')
_FIELD = re.compile(r'(\S+) +(\w+)(?: +(-[\d.]+))?')
_TAG = re.compile(r'<(\w+)>([^<]+)</\1>')
_COMMAND = re.compile(r'^(\w+)\(([^()]*)\)', re.MULTILINE)


def message_changes(source: str) -> Iterator[Change]:
    """Yield the changes to a message definition: constants, fields and their order."""
    lines = list(re.finditer(r'^[^\s#][^#\n]*?(?=\s*(?:#|$))', source, re.MULTILINE))
    for number, line in enumerate(lines):
        written = line[0]
        start, end = line.span()
        yield Change('missing line', start, end, '')
        constant, field = _CONSTANT.fullmatch(written), _FIELD.fullmatch(written)
        if constant:
            kind, name, value = constant.groups()
            yield Change('type', start, end, f'{OTHER_TYPE[kind]} {name}={value}')
            yield Change('name', start, end, f'{kind} {slip(name)}={value}')
            yield Change('off by one', start, end, f'{kind} {name}={int(value) + 1}')
            yield Change('constant', start, end, f'{kind} {name} {value}')
        elif field:
            kind, name, default = field[1], field[2], f' {field[3]}' if field[3] else ''
            yield Change('type', start, end, f'{OTHER_TYPE[kind]} {name}{default}')
            yield Change('name', start, end, f'{kind} {slip(name)}{default}')
            if default:
                yield Change('default', start, end, f'{kind} {name}')
                yield Change('default', start, end, f'{kind} {name} ={default}')
                yield Change('sign', start, end, f'{kind} {name} {default[2:]}')
            following = lines[number + 1] if number + 1 < len(lines) else None
            if following:
                between = source[line.end() : following.start()]
                swapped = f'{following[0]}{between}{line[0]}'
                yield Change('order', start, following.end(), swapped)


def manifest_changes(source: str) -> Iterator[Change]:
    """Yield the changes to a package.xml: a tag that is missing, misspelt or not closed."""
    for tag in _TAG.finditer(source):
        if tag[1] in ('version', 'description', 'license', 'maintainer'):
            continue
        yield Change('missing line', tag.start(), tag.end(), '')
        if tag[1] in ('name', 'member_of_group'):
            yield Change('name', tag.start(2), tag.end(2), slip(tag[2]))
    last = tag.start() + tag[0].index('</')
    yield Change('unclosed tag', last, last + 2, '<')


def cmake_changes(source: str) -> Iterator[Change]:
    """Yield the changes to a CMakeLists.txt: a missing command or argument."""
    for command in _COMMAND.finditer(source):
        if command[1] in ('install', 'cmake_minimum_required'):
            continue
        yield Change('missing line', command.start(), command.end(), '')
        if command[1] == 'rosidl_generate_interfaces':
            for word in re.finditer(r'DEPENDENCIES \w+', command[0]):
                start = command.start() + word.start()
                yield Change('missing line', start, command.start() + word.end(), '')
            name = command.start() + command[0].index('.msg')
            yield Change('name', name, name + 4, '')
        elif command[2].startswith('rosidl_default_generators'):
            yield Change('name', command.start(2), command.end(2), slip(command[2]))


def settings_changes(source: str) -> Iterator[Change]:
    """Yield the changes to a setup.cfg or a YAML file: a missing line, or a misspelt word."""
    for line in re.finditer(r'^ *([^\s#].*)\n', source, re.MULTILINE):
        yield Change('missing line', line.start(), line.end(), '')
        for word in re.finditer(r'[a-z_]{3,}', line[1]):
            start = line.start(1) + word.start()
            yield Change('name', start, line.start(1) + word.end(), slip(word[0]))


def answer_changes(source: str) -> Iterator[Change]:
    """Yield the change of a letter to the next one."""
    found = re.search(r"'([a-d])'", source)
    if found:
        other = 'abcd'[('abcd'.index(found[1]) + 1) % 4]
        yield Change('another letter', found.start(1), found.end(1), other)


BY_SUFFIX: dict[str, Callable[[str], Iterator[Change]]] = {
    '.msg': message_changes,
    '.xml': manifest_changes,
    'CMakeLists.txt': cmake_changes,
    '.cfg': settings_changes,
    '.yaml': settings_changes,
    '.txt': answer_changes,
}
