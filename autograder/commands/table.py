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

from autograder.classroom.course_lock import alone
from autograder.commands.exit_codes import FOR_REVIEW, OK
from autograder.commands.grade import add_yes
from autograder.errors import GraderError, SandboxUnavailable
from autograder.layout import Layout


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
        help='an exam (such as talker), or an assignment (topics)',
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
        '--trust-names',
        action='store_true',
        help="take work from nbgrader's exchange by its name, without checking its owner "
        '(see docs/exchange.md)',
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
    add_yes(rejudge)
    rejudge.add_argument('--json', action='store_true', help='print the changes as JSON')
    rejudge.set_defaults(run=_rejudge)

    forget = commands.add_parser(
        'forget', help='show what the course has of a student; with --yes, remove it'
    )
    forget.add_argument('students', nargs='+', metavar='STUDENT', help='id or name')
    forget.add_argument('--yes', action='store_true', help='remove it')
    forget.set_defaults(run=_forget)

    explain = commands.add_parser('explain', help='show the evidence behind a verdict')
    explain.add_argument('student', metavar='STUDENT', help='id or name')
    explain.add_argument(
        'check',
        metavar='CHECK',
        nargs='?',
        help='its name, or EXAM/CHECK (default: list the checks of the student)',
    )
    explain.add_argument('--assignment', metavar='NAME', help='if the check is in several')
    explain.add_argument('--submitted', type=Path, metavar='DIR', help='as for grade')
    explain.add_argument('--json', action='store_true', help='all of it, as JSON')
    explain.set_defaults(run=_explain)


def _run(chosen: argparse.Namespace) -> int:
    """Look at one submission."""
    from autograder.commands import run as quick_look

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
    from autograder.authoring.sample_class import take_out_sample_class
    from autograder.classroom.not_collected import names_to_write_to, read_not_collected
    from autograder.collect.table import LEFT, print_rows
    from autograder.collect.take_in import collect
    from autograder.explaining.feedback import printable

    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment) if chosen.assignment else ''
    to = chosen.to or layout.submitted
    write = not chosen.dry_run
    with alone(layout, 'a collection') if write else nullcontext():
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
        if taken and (count := take_out_sample_class(layout)):
            said = f'The {count} example students were taken out of {to.name}/ and the gradebook.'
            print(said, file=sys.stderr)
    if chosen.json:
        print(json.dumps([row.to_json() for row in rows]))
    else:
        print_rows(rows, to, write)
        if missing := read_not_collected(layout):
            print(printable(f'Nothing to grade yet from: {names_to_write_to(missing)}'))
    return FOR_REVIEW if any(row.done == LEFT for row in rows) else OK


def _show(event: Any) -> None:
    """Print an event of a run as it happens; the results may go elsewhere as JSON."""
    from autograder.explaining.live import live_line

    line = live_line(event)
    if line:
        print(line, file=sys.stderr, flush=True)


def _sandbox(visible: bool) -> Any:
    """Return the strongest sandbox; only visible checks may do without."""
    from autograder.sandboxes import choose

    try:
        return choose.strongest()
    except SandboxUnavailable as error:
        if not visible:
            raise
        print(f'No sandbox here, so this runs as a plain process: {error.what}', file=sys.stderr)
        return choose.plain()


def _rejudge(chosen: argparse.Namespace) -> int:
    """Judge again."""
    from autograder.commands.rejudge import rejudge_command

    layout = Layout.here()
    with alone(layout, 'rejudge --write') if chosen.write else nullcontext():
        changes, code = rejudge_command(
            layout, chosen.assignment, chosen.submitted, chosen.write, chosen.yes
        )
    if chosen.json:
        print(json.dumps([change.to_json() for change in changes]))
    else:
        for change in changes:
            print(change.text())
    if refused := ' '.join(dict.fromkeys(one.refused for one in changes if one.refused)):
        raise GraderError(refused)
    return code


def _forget(chosen: argparse.Namespace) -> int:
    """Show what the course has of students, and remove it if that is meant."""
    from autograder.commands.forget import forget, traces

    layout, copies = Layout.here(), []
    with alone(layout, 'forget') if chosen.yes else nullcontext():
        found = [traces(layout, student) for student in chosen.students]
        for one in found:
            print('\n'.join(one.lines(layout)))
        if chosen.yes:
            copies = [forget(layout, one.student) for one in found]
    if not chosen.yes:
        print('Nothing was removed. Try: the same command with --yes')
        return OK
    print('Removed. Earlier exports and copies of the gradebook still have what was in them.')
    if copies[0]:
        print(f'The gradebook as it was: {copies[0]}')
    return OK


def _explain(chosen: argparse.Namespace) -> int:
    """Show the evidence."""
    from autograder.commands.explain import evidence, evidence_text, results_of, verdicts_text

    layout = Layout.here()
    if chosen.check is None:
        results = results_of(layout, chosen.student, chosen.assignment)
        as_json = [result.to_json() for result in results]
        print(json.dumps(as_json) if chosen.json else verdicts_text(layout, results))
        return OK
    found = evidence(layout, chosen.student, chosen.check, chosen.assignment, chosen.submitted)
    print(json.dumps(found) if chosen.json else evidence_text(found))
    return OK
