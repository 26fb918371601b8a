"""
Check the files of a package, and explain a failed build of its messages.

The functions are bodies of checks, as in :mod:`autograder.judging.checks`, for ``.msg`` files,
``package.xml`` and ``CMakeLists.txt``.  :mod:`autograder.judging.causes.builds` explains a build
from the output of the tools.  All of this input is untrusted.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
import re
import xml.etree.ElementTree as ElementTree

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.words import rows
from autograder.judging.causes.builds import (
    diagnose,
    output_of,
    why_build_failed,
    why_no_messages,
)
from autograder.judging.causes.ended import close_name, LIMITS, why_killed
from autograder.judging.causes.text_table import cause_of, FOLDER, rows_of

Fields = Sequence[tuple[str, str]]
"""Types and names of fields, in order."""

LONGEST_CMAKE = 20_000
"""Maximum length that is read [characters]; the lesson's file has 700."""
_BOUNDS = (
    (re.compile(r'\[(\d+)\]$'), '[{0}] is exactly {0}'),
    (re.compile(r'\[<=(\d+)\]$'), '[<={0}] is at most {0}'),
    (re.compile(r'<=(\d+)$'), '<={0} is at most {0} characters'),
)


def fields_of(text: str) -> list[tuple[str, str]]:
    """
    Return the fields of a message definition as (type, name) pairs, in order, without constants.

    :param text: content of a .msg file; a line that is not a valid field gives its first two words
    """
    found = []
    for line in text.splitlines():
        words = line.partition('#')[0].split()
        name, behind = words[1] if len(words) > 1 else '', words[2] if len(words) > 2 else ''
        constant = '=' in name.replace('<=', '') or behind.startswith('=')
        if words and not constant:
            found.append((words[0], name))
    return found


def require_fields(text: str, wanted: Fields) -> None:
    """Fail unless a message definition has exactly the given fields, in order."""
    found = fields_of(text)
    if found == list(wanted):
        return
    right = sum(field in found for field in wanted)
    raise Failed(
        expected='; '.join(' '.join(field) for field in wanted),
        observed='; '.join(' '.join(field) for field in found)[:300] or 'no field',
        share=0.0 if len(found) > len(wanted) + 2 else round(right / (2 * len(wanted)), 2),
        why=_why_fields(found, wanted, text),
    )


def _why_fields(found: Fields, wanted: Fields, text: str) -> Cause:
    types = {name: kind for kind, name in wanted}
    wrong = [field for field in found if field not in wanted]
    if wrong:
        cause = _why_wrong(*wrong[0], types)
        more = '; '.join(' '.join(field).strip()[:40] for field in wrong[1:4])
        return replace(cause, text=f'{cause.text} Also fix: {more}' if more else cause.text)
    names = [name for _, name in found]
    missing = [name for name in types if name not in names]
    for line in map(str.strip, text.splitlines()):
        code = line.partition('#')[0]
        if any(re.search(rf'\b{name}\b', code) for name in missing):
            return cause_of('field_line', text=line[:60])
    if missing:
        are = 'is' if len(missing) == 1 else 'are'
        return cause_of('field_missing', missing=f'{", ".join(missing)} {are}')
    if twice := next((name for name in names if names.count(name) > 1), ''):
        return cause_of('field_twice', field=twice)
    found_there, due = next(pair for pair in zip(names, types) if pair[0] != pair[1])
    return cause_of('field_order', field=found_there, due=due)


def _why_wrong(kind: str, name: str, types: Mapping[str, str]) -> Cause:
    """Explain a line that is not a field of the specification."""
    line = f'{kind} {name}'.strip()[:80]
    names = f'(?P<name>{"|".join(types)})'
    for row in rows_of('of_fields.txt'):
        found = re.search(row.when.replace('NAME', names), line)
        words = found.groupdict() if found else {}
        wanted = types.get(words.get('name', ''), '')
        both = f'{words.get("kind", "")}\n{wanted}'
        if found and all(re.search(condition, both) for condition in row.more):
            return row.cause(**words, line=line, wanted=wanted, bound=_bound_of(wanted))
    near = close_name(name, types)
    advice = f'Did you mean {near}?' if near else 'Compare with the table.'
    return cause_of('field_name', field=repr(name[:40]), advice=advice)


def _bound_of(wanted: str) -> str:
    for pattern, text in _BOUNDS:
        if match := pattern.search(wanted):
            return text.format(match[1])
    return 'The table has no bound'


_DECLARATIONS = (FOLDER / 'of_manifests.txt').read_text(encoding='utf-8')
_BUILD_TYPES = {
    'ament_cmake': 'Only packages of type ament_cmake can have messages.',
    'ament_python': 'This type tells colcon to build the package with setup.py.',
}


def require_declarations(
    text: str, package: str, needed: str = _DECLARATIONS, build_type: str = 'ament_cmake'
) -> None:
    """
    Fail unless a package.xml declares everything that its package needs.

    :param needed: rows as in ``of_manifests.txt``, by default those for a message package
    """
    try:
        root = ElementTree.fromstring(text)  # noqa: S314 - expat rejects XML bombs
    except ElementTree.ParseError as error:
        raise Failed(
            expected='a well-formed package.xml',
            observed=f'XML that cannot be read: {error}',
            why=cause_of('xml'),
        ) from None
    have = {(child.tag, (child.text or '').strip()) for child in root}
    declarations = rows(needed)
    missing = _undeclared(declarations, have)
    name, kind = root.findtext('name', '').strip(), root.findtext('export/build_type', '').strip()
    if name != package:
        missing = {f'<name>{package}</name>': f'The package is called {name[:40]!r}.', **missing}
    if kind != build_type:
        line = f'<export><build_type>{build_type}</build_type></export>'
        missing[line] = _BUILD_TYPES[build_type]
    if missing:
        total = len(declarations) + 2
        first = next(iter(missing))
        raise Failed(
            expected='all declarations that the package needs',
            observed='missing: ' + ', '.join(missing),
            share=round(0.5 * (1 - len(missing) / total), 2) if len(missing) < total // 2 else 0,
            why=Cause('manifest', missing[first], f'Write {first}.'),
        )


def _undeclared(
    declarations: Iterable[Sequence[str]], have: set[tuple[str, str]]
) -> dict[str, str]:
    """Return the missing declarations, each with the reason why it is needed."""
    missing = {}
    for line, ways, why in declarations:
        needed = ElementTree.fromstring(line).text or ''
        if any({(tag, needed) for tag in way.split()} <= have for way in ways.split('|')):
            continue
        for tag in sorted(tag for tag, name in have if name == needed)[:1]:
            why = f'{needed} is declared with <{tag[:40]}>, which has a different meaning. {why}'
        missing[line] = why
    return missing


def require_registered(text: str) -> None:
    """Fail if a package's CMakeLists.txt generates messages but does not register them."""
    bare = re.sub(r'#[^\n]*', '', text[:LONGEST_CMAKE]).lower()
    called = re.findall(r'\b(ament_(?:auto_)?package|rosidl_generate_interfaces)\s*\(', bare)
    if set(called) == {'rosidl_generate_interfaces'}:
        raise Failed(
            expected='a package that ROS 2 finds once it is installed',
            observed='CMakeLists.txt without ament_package()',
            share=0.5,
            why=cause_of('not_registered'),
        )


def commands_of(text: str) -> list[tuple[str, list[str]]]:
    """
    Return the commands of a CMake file as (command, arguments) pairs.

    Command names are in lower case.  Comments and quotes are removed, and variables from ``set``,
    ``list(APPEND)`` and ``project`` are replaced by their values.  Bracket arguments and generator
    expressions, which no lesson uses, are not parsed.
    """
    bare = re.sub(r'#[^\n]*', '', text[:LONGEST_CMAKE])
    variables: dict[str, str] = {}
    found = []
    for match in re.finditer(r'(?<!\w)([A-Za-z_]\w{0,63})\s{0,99}\(([^()]*)\)', bare):
        name = match[1].lower()
        given = re.sub(r'\$\{(\w+)\}', lambda used: variables.get(used[1], used[0]), match[2])
        words = re.findall(r'[^\s";]+', given)
        if name == 'project' and words:
            variables['PROJECT_NAME'] = words[0]
        elif name == 'set' and words:
            variables[words[0]] = ' '.join(words[1:])
        elif name == 'list' and words[:1] == ['APPEND'] and len(words) > 1:
            variables[words[1]] = ' '.join([variables.get(words[1], ''), *words[2:]])
        found.append((name, words))
    return found


def mistake_in_build(run: Run) -> Cause:
    """Return why a build failed, from the output of the tools, see :func:`diagnose`."""
    output = output_of(run.recording)
    built = 'Traceback' in output and 'echo_node.py' in output
    return why_no_messages(output, run.files) if built else diagnose(output, run.files)


def why_no_build(run: Run) -> Cause:
    """Explain why no message of a package arrived, from the way its build ended."""
    killed = str(run.recording.process.get('killed', ''))
    if killed in LIMITS:
        return why_killed(killed, 'build')
    return why_build_failed(mistake_in_build(run))
