"""The command ``collect``: its options and its output."""

import argparse
from contextlib import nullcontext
from itertools import groupby
from operator import attrgetter
from pathlib import Path
import sys

from autograder.authoring.sample_class import remove_sample_class
from autograder.classroom.collected import read_not_collected
from autograder.classroom.course_lock import lock_course
from autograder.classroom.standing import names_for_email
from autograder.collect.copy_notebooks import collect, print_rows
from autograder.collect.deliveries import LEFT
from autograder.commands import flag, FOR_REVIEW, OK, option, takes, TO_SUBMITTED
from autograder.explaining.feedback import printable
from autograder.layout import Layout


@takes(
    option('source', 'folder, zip file or exchange to read', type=Path, metavar='SOURCE'),
    option(
        '--assignment',
        'treat all work as this assignment (default: recognise it by the notebooks)',
        default='',
        metavar='NAME',
    ),
    option(
        '--kind',
        'platform that SOURCE comes from (default: recognise it by the file names)',
        choices=('canvas', 'moodle', 'gradescope', 'exchange', 'folder'),
        default='',
    ),
    option(
        '--prefix',
        "remove this prefix from students' folder names, such as hw1- from hw1-ANN",
        default='',
        metavar='TEXT',
    ),
    flag(
        '--trust-names',
        "trust the names: do not check who owns the folders in nbgrader's exchange "
        '(see docs/exchange.md), or whether known students have new numbers in Moodle',
    ),
    TO_SUBMITTED,
    flag('--all', 'print all rows, including unchanged work and work without a note'),
    flag('--dry-run', 'print the table and write nothing'),
)
def run(chosen: argparse.Namespace) -> int:
    """Collect the submissions of a class and print the table."""
    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment) if chosen.assignment else ''
    to = chosen.to or layout.submitted
    write = not chosen.dry_run
    with lock_course(layout, 'collect') if write else nullcontext():
        rows = collect(
            chosen.source,
            layout,
            to,
            assignment,
            chosen.kind,
            write,
            prefix=chosen.prefix,
            trust_names=chosen.trust_names,
        )
        ours = write and to.resolve() == layout.submitted.resolve()
        taken = ours and any(row.done != LEFT for row in rows)
        if taken and (count := remove_sample_class(layout)):
            said = f'Removed the {count} example students from {to.name}/ and the gradebook.'
            print(said, file=sys.stderr)
    print_rows(rows, to, write, chosen.all)
    missing = sorted(read_not_collected(layout), key=attrgetter('assignment'))
    for name, works in groupby(missing, attrgetter('assignment')):
        whose = names_for_email([*works])
        print(printable(f'Nothing to grade yet for {name or "an unknown lesson"} from: {whose}'))
    return FOR_REVIEW if any(row.done == LEFT for row in rows) else OK
