"""The command ``similar``: list similar submissions for a person to compare."""

import argparse
from dataclasses import asdict

from autograder.classroom.similarity import Pair, Similar, similar
from autograder.commands import ASSIGNMENT, JSON, OK, option, show, SUBMITTED, takes
from autograder.explaining.feedback import printable
from autograder.layout import Layout

COMMON_LINES = 6


def _percent(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1 <= value <= 100:
        raise argparse.ArgumentTypeError(f'expected a number from 1 to 100, got {text!r}')
    return value


@takes(
    ASSIGNMENT,
    SUBMITTED,
    option(
        '--at-least',
        'list pairs at least this similar (default: %(default)g)',
        type=_percent,
        default=85.0,
        metavar='PERCENT',
    ),
    JSON,
)
def run(chosen: argparse.Namespace) -> int:
    """Print the pairs of similar submissions."""
    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment)
    submitted = chosen.submitted or layout.submitted
    found = similar(layout, assignment, submitted, chosen.at_least / 100)
    show(chosen.json, asdict(found), similar_text(found))
    return OK


def similar_text(found: Similar) -> str:
    """Return the pairs as plain text."""
    lines = [f'{found.assignment}: {found.compared} submissions compared. {found.warning}']
    if found.typical is not None:
        lines.append(f'Two submissions of this class are typically {found.typical:.0%} alike.')
    for pair in found.pairs:
        lines += ['', *_pair_lines(pair)]
    if not found.pairs:
        lines.append(f'No two submissions are {found.at_least:.0%} or more alike.')
    if found.more:
        lines.append(f'\n... and {found.more} more pairs. Try: a higher --at-least')
    if found.short:
        lines.append('')
        lines.append(f'Too little code of their own to compare: {", ".join(found.short)}')
    return printable('\n'.join(lines))


def _pair_lines(pair: Pair) -> list[str]:
    names = ' = '.join(pair.first)
    if pair.second:
        names = f'{names}  ~  {" = ".join(pair.second)}'
    said = f'{pair.score:4.0%}  {names}'
    if pair.renamed:
        said += f'  (only names differ in {pair.renamed:.0%} of the common lines)'
    lines = [said]
    common = [both for part in pair.common for both in zip(part.first, part.second)]
    for first, second in common[:COMMON_LINES]:
        lines.append(f'      | {first}' + (f'   <>   {second}' if first != second else ''))
    if more := len(common[COMMON_LINES:]):
        lines.append(f'      | ... {more} more lines (see --json)')
    return lines
