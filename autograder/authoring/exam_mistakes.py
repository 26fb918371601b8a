"""
Find mistakes in an exam before a class is graded; report each in one line with its place.

An exam checks its own scenario when it is created: steps that name an unknown topic, a malformed
type.  ``release check`` and ``self-check`` test the rest: whether the types exist and can hold the
values needs an installed ROS, and whether a section to read exists needs the lessons.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
import re
from typing import TYPE_CHECKING

from autograder.authoring.exam_values import value_mistakes
from autograder.exam import catalog

if TYPE_CHECKING:
    from autograder.exam.exam import Exam

SECRETS = 200
"""With so many secrets an exam is drawn to see that its inputs do, whatever they are."""
_ELSEWHERE = re.compile(r'^lesson (\d\d), (.+)$')


# -- with an installed ROS ------------------------------------------------------------------


def type_mistakes(exam: Exam, prefixes: Sequence[Path]) -> Iterator[str]:
    """
    Yield types that are not installed, and fields and values that their messages do not have.

    :param prefixes: where ROS packages are installed, as in ``AMENT_PREFIX_PATH``
    """
    scenario, where = exam.scenario, f'exam {exam.name}'
    types: dict[str, str] = {}
    for place, topic, name in scenario.types():
        types[topic] = name
        if problem := _unknown(name, prefixes):
            yield f'{where}, {place}: {problem}'
    for place, step in scenario.placed():
        for part, name, values in step.sends():
            for problem in value_mistakes(types.get(name, name), values, prefixes):
                yield f'{where}, {place}{part}: {problem}'


def _unknown(name: str, prefixes: Sequence[Path]) -> str:
    """Return what is wrong with the name of a type, empty if it is installed."""
    package, _, rest = name.partition('/')
    packages = installed(tuple(prefixes))
    if package not in packages:
        close = get_close_matches(package, packages, n=1, cutoff=0.6)
        hint = f'; did you mean {close[0]}?' if close else '.'
        return (
            f'expected a type of an installed package, got {name}{hint} '
            'Try: name further packages in environment/messages.txt'
        )
    if rest not in packages[package]:
        close = get_close_matches(rest, packages[package], n=1, cutoff=0.6)
        hint = f'; did you mean {package}/{close[0]}?' if close else ''
        return f'expected a type of {package}, got {name}{hint}'
    return ''


@lru_cache(maxsize=4)
def installed(prefixes: tuple[Path, ...]) -> Mapping[str, tuple[str, ...]]:
    """
    Return the installed interfaces by package, such as ``msg/String``.

    :param prefixes: as in ``AMENT_PREFIX_PATH``
    """
    found: dict[str, tuple[str, ...]] = {}
    for prefix in prefixes:
        index = prefix / 'share' / 'ament_index' / 'resource_index' / 'rosidl_interfaces'
        for entry in sorted(index.glob('*')) if index.is_dir() else ():
            lines = entry.read_text(encoding='utf-8').split()
            names = sorted({line.rpartition('.')[0] for line in lines})
            found.setdefault(entry.name, tuple(names))
    return found


def differs_from_visible(exam: Exam, visible: Exam) -> Iterator[str]:
    """
    Yield the facts in which a hidden exam differs from the visible one, apart from inputs.

    :param visible: what ``check(...)`` runs in their notebook
    """
    for what in ('cells', 'requires', 'part', 'assignment'):
        if getattr(exam, what) != getattr(visible, what):
            yield (
                f'exam {exam.name}: expected the same {what} as in the visible exam, '
                f'{getattr(visible, what)!r}, got {getattr(exam, what)!r}'
            )


def inseparable_slips(exam: Exam) -> Iterator[str]:
    """
    Yield slips that some secret's inputs cannot distinguish from right answers or other slips.

    With these inputs, a program with such a slip would get full marks or a wrong cause.
    """
    seen: dict[str, str] = {}
    for number in range(SECRETS if exam.asks else 0):
        other = catalog.drawn(exam.name, f'secret {number}')
        for name, asked in other.asks.items():
            for mistake in asked.mistakes():
                seen.setdefault(f'{name}: {mistake}', f'secret {number}')
    for mistake, secret in seen.items():
        yield f'exam {exam.name}, {mistake}; first found with secret {secret!r} of {SECRETS}'


# -- with the lessons -----------------------------------------------------------------------


def read_mistakes(exam: Exam, headings: Mapping[str, AbstractSet[str]]) -> Iterator[str]:
    """
    Yield checks that name no section to read, or a section that no lesson has.

    :param headings: of each lesson, see :func:`lesson_headings`; without those of the exam's own
        lesson, this only checks that a section is named
    """
    for check in exam.checks:
        where, section = f'exam {exam.name}, check {check.name}', check.read or exam.read
        if not section.strip():
            yield f'{where}: expected a section to read, got none'
        elif exam.assignment in headings and (
            problem := no_section(section, exam.assignment, headings)
        ):
            yield f'{where}: {problem}'


def no_section(section: str, lesson: str, headings: Mapping[str, AbstractSet[str]]) -> str:
    """
    Return what is wrong with a section to read, empty if it is a heading.

    :param section: such as ``Part 2: Names``, ``lesson 02, When a timer ticks``, or, without a
        heading, ``lesson 02, on clocks``
    :param lesson: the lesson of a section that names none
    """
    heading = section
    if elsewhere := _ELSEWHERE.match(section):
        number, heading = elsewhere.groups()
        lesson = next((name for name in sorted(headings) if name.startswith(f'{number}_')), '')
        if not lesson:
            return f'expected a lesson to read, got {section!r}: there is no lesson {number}'
        if heading.startswith('on '):  # the subject of a question, not a heading
            return ''
    if heading in headings[lesson]:
        return ''
    close = get_close_matches(heading, headings[lesson], n=1, cutoff=0.6)
    hint = f'; did you mean {close[0]!r}?' if close else ''
    return f'expected a heading of {lesson} to read, got {heading!r}{hint}'


def lesson_headings(notebooks: Path) -> dict[str, AbstractSet[str]]:
    """
    Return the headings of every released lesson that can be read, by its folder.

    :param notebooks: folder of the released notebooks
    """
    from autograder.submission.notebook import read_release

    found: dict[str, AbstractSet[str]] = {}
    for path in sorted(notebooks.glob('*/*.ipynb')):
        try:
            cells = read_release(path)['cells']
        except (OSError, ValueError):
            continue  # this check is not about unreadable notebooks
        texts = [cell['source'] for cell in cells if cell['cell_type'] == 'markdown']
        lines = '\n'.join(texts).splitlines()
        titles = {line.lstrip('#').strip() for line in lines if line.startswith('#')}
        found[path.parent.name] = titles
    return found


# -- all of it ------------------------------------------------------------------------------


def ament_prefixes() -> tuple[Path, ...]:
    """Return where the ROS packages of the prepared environment are installed."""
    from environment.ros import ros_environment

    return tuple(map(Path, ros_environment().variables['AMENT_PREFIX_PATH'].split(':')))


def mistakes_of(exam: Exam, notebooks: Path) -> list[str]:
    """
    Return all mistakes of a hidden exam that can be found without running it, one line each.

    :param exam: a hidden exam of the course
    :param notebooks: folder of the released notebooks
    """
    file = exam.scenario.file
    needless = exam.scenario.program != 'node' or file in exam.requires
    return [
        *([] if needless else [f'exam {exam.name}: runs {file!r}, which it does not require']),
        *type_mistakes(exam, ament_prefixes()),
        *read_mistakes(exam, lesson_headings(notebooks)),
        *inseparable_slips(exam),
        *differs_from_visible(exam, catalog.load(exam.name, hidden=False)),
    ]
