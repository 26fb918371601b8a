"""
Write docs/attacks.md: every attack with its aim, its defence and its points.

``python -m tests.attacks.table`` writes it; ``--check`` only compares and fails if it is out of
date.  The tests in tests/attacks assert these points, so the table cannot claim different ones.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
import sys

from autograder.exam import catalog
from tests.attacks import hostile_folders, hostile_notebooks  # noqa: F401 - they fill HANDED_IN
from tests.attacks.archives import REFUSED
from tests.attacks.corpus import Attack, NOTEBOOKS, programs
from tests.attacks.notebook_builder import HANDED_IN

PAGE = Path(__file__).parents[2] / 'docs' / 'attacks.md'
HEAD = """# Attacks

The {count} submissions in `tests/attacks/` try to cheat the grader, to read hidden data, or to
break the grader. Each is graded like any other submission, with the real sandbox and the hidden
exams, and `pytest tests/attacks` asserts for each that

* it gets the points that its honest part deserves: exactly, or, if it varies from run to run, not
  more ("at most"); no attack makes the grader decline to judge;
* its run ends within a minute, for the reason given here;
* a canary in the grader's environment, memory and open files never appears in the program's output
  or messages, the recording, the report or the feedback;
* the instructor sees the flag given here;
* all other students get the same grades as without the attack, and the batch continues.

Generated from the files by `python -m tests.attacks.table`. `docs/threat-model.md` states what the
sandbox guarantees and what it does not.
"""


def page() -> str:
    found = [*programs(), *(about for _, (about, _) in sorted(HANDED_IN.items()))]
    parts = [HEAD.format(count=len(found) + len(REFUSED))]
    for kind, group in groupby(found, key=lambda one: one.kind):
        parts.append('\n'.join(_section(kind, list(group))))
    return '\n'.join([*parts, *_archives()])


def _archives() -> Iterator[str]:
    yield '## Zip files\n\nRefused entirely; nothing is written.\n'
    yield '| Attack | Tries to | Error |'
    yield '|---|---|---|'
    for trick, said in REFUSED.items():
        tries = _lower(trick.__doc__ or '')
        yield f'| {trick.__name__.replace("_", " ")} | {tries} | “{said}” |'
    yield ''


def _section(kind: str, group: Sequence[Attack]) -> list[str]:
    if kind == NOTEBOOKS:
        title = '## Notebooks and folders as submitted'
        what = 'Points of the whole lesson 07, of 50.'
    else:
        title = f'## Programs for the exam {kind}'
        what = f'Of {catalog.load(kind).max_points:g} points.'
    head = '| Attack | Tries to | Stopped by | Deserves and gets | Run ends with | Flag |'
    lines = [title, '', what, '', head, '|---|---|---|---|---|---|']
    return [*lines, *map(_row, group), '']


def _row(attack: Attack) -> str:
    points = f'{attack.points:g}{" at most" * attack.at_most}'
    flags = ', '.join(f'“{flag}”' for flag in attack.flags)
    name = attack.name.replace('_', ' ')
    ends = f'`{attack.ends}`' if attack.ends else ''
    cells = (name, _lower(attack.tries), attack.stopped_by, points, ends, flags)
    return f'| {" | ".join(cell.replace("|", "&#124;") for cell in cells)} |'


def _lower(tries: str) -> str:
    tries = tries.strip().rstrip('.')
    return tries[0].lower() + tries[1:]


def main(arguments: Sequence[str]) -> int:
    text = page()
    if '--check' not in arguments:
        PAGE.write_text(text, encoding='utf-8')
        return 0
    if PAGE.is_file() and PAGE.read_text(encoding='utf-8') == text:
        return 0
    print('docs/attacks.md is out of date. Try: python -m tests.attacks.table')
    return 1


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
