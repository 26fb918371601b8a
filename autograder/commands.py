"""
The instructor's commands around single submissions, and ``collect``, with which a class begins.

Here are only their options and what they print; each has a module of its own.
"""

from __future__ import annotations

import argparse
from contextlib import nullcontext
import json
from pathlib import Path
import sys
from typing import Any

from autograder.errors import GraderError, SandboxUnavailable
from autograder.layout import Layout
from autograder.whole_class.alone import alone

OK, FOR_REVIEW = 0, 1


def add_commands(commands: Any) -> None:
    """
    Describe the commands.

    :param commands: what :meth:`argparse.ArgumentParser.add_subparsers` returns
    """
    run = commands.add_parser('run', help='run exams on one script, package, zip or notebook')
    run.add_argument('path', type=Path, metavar='PATH')
    run.add_argument(
        '--exam',
        required=True,
        metavar='NAME',
        help='an exam (temperature_publisher), or an assignment (temperature_monitor)',
    )
    run.add_argument('--visible', action='store_true', help='only the visible checks')
    run.add_argument('--live', action='store_true', help='show what happens while it happens')
    run.add_argument('--fresh', action='store_true', help='run again what is recorded')
    run.add_argument('--json', action='store_true', help='print the results as JSON')
    run.set_defaults(run=_run)

    collect = commands.add_parser(
        'collect', help='take in a class from a folder, a zip of an LMS or an exchange'
    )
    collect.add_argument('source', type=Path, metavar='SOURCE')
    collect.add_argument(
        '--assignment', default='', metavar='NAME', help='the only one (default: by the notebooks)'
    )
    collect.add_argument(
        '--kind',
        choices=('canvas', 'moodle', 'gradescope', 'exchange', 'folder'),
        default='',
        help='where it comes from (default: by the names in it)',
    )
    collect.add_argument(
        '--prefix',
        default='',
        metavar='TEXT',
        help="what the names of students' folders begin with, as in hw1-ANN; it is taken off",
    )
    collect.add_argument(
        '--to', type=Path, metavar='DIR', help='default: autograder/_work/submitted'
    )
    collect.add_argument('--dry-run', action='store_true', help='write nothing, only say')
    collect.add_argument('--json', action='store_true', help='print the table as JSON')
    collect.set_defaults(run=_collect)

    rejudge = commands.add_parser(
        'rejudge', help='new verdicts from the kept recordings after an exam edit; runs nothing'
    )
    rejudge.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='default: all')
    rejudge.add_argument('--submitted', type=Path, metavar='DIR', help='as for grade')
    rejudge.add_argument(
        '--write', action='store_true', help='enter the new points in gradebook and reports'
    )
    rejudge.add_argument('--json', action='store_true', help='print the changes as JSON')
    rejudge.set_defaults(run=_rejudge)

    explain = commands.add_parser('explain', help='the evidence behind a verdict, for an appeal')
    explain.add_argument('student', metavar='STUDENT')
    explain.add_argument('check', metavar='CHECK', help='its name, or EXAM/CHECK')
    explain.add_argument('--assignment', metavar='NAME', help='if the check is in several')
    explain.add_argument('--submitted', type=Path, metavar='DIR', help='as for grade')
    explain.add_argument('--json', action='store_true', help='all of it, as JSON')
    explain.set_defaults(run=_explain)


def _run(chosen: argparse.Namespace) -> int:
    """Look at one submission."""
    from autograder.whole_class import quick_look

    layout = Layout.here()
    found = quick_look.exams_named(chosen.exam, layout, hidden=not chosen.visible)
    looks = quick_look.looks(chosen.path, found, layout)
    sandbox = _sandbox(chosen.visible)
    results = []
    for look, result in quick_look.quick_look(
        looks,
        sandbox,
        layout.recordings,
        fresh=chosen.fresh,
        told=_show if chosen.live else None,
    ):
        results.append(result)
        if not chosen.json:
            print(quick_look.text_of(look, result))
    if chosen.json:
        print(json.dumps([result.to_json() for result in results]))
    else:
        print(quick_look.summary(results, chosen.visible))
    return OK


def _collect(chosen: argparse.Namespace) -> int:
    """Take in a class."""
    from autograder.collect import collect, LEFT, print_rows
    from autograder.sample_class import take_out_sample_class

    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment) if chosen.assignment else ''
    to = chosen.to or layout.submitted
    write = not chosen.dry_run
    with alone(layout, 'a collection') if write else nullcontext():
        rows = collect(
            chosen.source, layout, to, assignment, chosen.kind, write, prefix=chosen.prefix
        )
        ours = write and to.resolve() == layout.submitted.resolve()
        taken = ours and any(row.done != LEFT for row in rows)
        if taken and (count := take_out_sample_class(layout)):
            said = f'The {count} example students were taken out of {to.name}/ and the gradebook.'
            print(said, file=sys.stderr)
    if chosen.json:
        print(json.dumps([row.to_json() for row in rows]))
    else:
        print_rows(rows, to, write)
    return FOR_REVIEW if any(row.done == LEFT for row in rows) else OK


def _show(event: Any) -> None:
    """Print an event of a run as it happens; the results may go elsewhere as JSON."""
    from autograder.live import live_line

    line = live_line(event)
    if line:
        print(line, file=sys.stderr, flush=True)


def _sandbox(visible: bool) -> Any:
    """Return the strongest sandbox; only visible checks may do without."""
    from autograder.sandboxes import sandbox

    try:
        return sandbox.strongest()
    except SandboxUnavailable as error:
        if not visible:
            raise
        print(f'No sandbox here, so this runs as a plain process: {error.what}', file=sys.stderr)
        return sandbox.plain()


def _rejudge(chosen: argparse.Namespace) -> int:
    """Judge again."""
    from autograder.whole_class.rejudge import rejudge_command

    layout = Layout.here()
    with alone(layout, 'rejudge --write') if chosen.write else nullcontext():
        changes, code = rejudge_command(layout, chosen.assignment, chosen.submitted, chosen.write)
    if chosen.json:
        print(json.dumps([change.to_json() for change in changes]))
    else:
        for change in changes:
            print(change.text())
    if refused := ' '.join(one.refused for one in changes if one.refused):
        raise GraderError(refused)
    return code


def _explain(chosen: argparse.Namespace) -> int:
    """Show the evidence."""
    from autograder.whole_class.explain import evidence, evidence_text

    found = evidence(
        Layout.here(), chosen.student, chosen.check, chosen.assignment, chosen.submitted
    )
    print(json.dumps(found) if chosen.json else evidence_text(found))
    return OK
