"""The command ``similar``: list similar submissions for a person to compare."""

import argparse
from pathlib import Path

from autograder.classroom.similarity import Similar, similar
from autograder.commands import ASSIGNMENT, OK, option, SUBMITTED, takes
from autograder.explaining.feedback import printable
from autograder.layout import Layout

WARNING = (
    'Similarity proves nothing. Small exercises have few good answers, and students may have been '
    'allowed to work together. Read both files before you speak to a student.'
)


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
)
def run(chosen: argparse.Namespace) -> int:
    """Print the pairs of similar submissions."""
    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment)
    submitted = chosen.submitted or layout.submitted
    at_least = chosen.at_least / 100
    found = similar(layout, assignment, submitted, at_least)
    print(similar_text(found, assignment, submitted, at_least))
    return OK


def similar_text(found: Similar, assignment: str, submitted: Path, at_least: float) -> str:
    """Return the pairs as plain text."""
    lines = [f'{assignment}: {found.compared} submissions compared. {WARNING}']
    if found.typical is not None:
        lines.append(f'Two submissions of this class are typically {found.typical:.0%} alike.')
    if found.pairs:
        lines += [f'The files are {submitted}/STUDENT/{assignment}/*.ipynb.', '']
    else:
        lines.append(f'No two submissions are {at_least:.0%} or more alike.')
    lines += [
        f'{score:4.0%}  {common:3} common lines  {first}  ~  {second}'
        for score, first, second, common in found.pairs
    ]
    if found.more:
        lines.append(f'... and {found.more} more pairs. Try: a higher --at-least')
    if found.short:
        lines += ['', f'Too little code of their own to compare: {", ".join(found.short)}']
    return printable('\n'.join(lines))
