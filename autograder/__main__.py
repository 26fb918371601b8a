"""
The grader on the command line; COMMAND --help says more about each.

Exit codes: 0 everything has a verdict, 1 some submissions are for review, 2 the command cannot
be done (its arguments, or our own fault), 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
import select
import sys

from autograder.commands import (
    authoring,
    check,
    collect,
    explain,
    export,
    forget,
    grade,
    rejudge,
    run,
    similar,
    stats,
    STOPPED,
    UNREAD,
    USAGE,
)
from autograder.grading.pipeline import end_runs
from autograder.layout import CHOSEN

COMMANDS = {
    'grade': ('grade a class and write reports', grade.options, grade.run),
    'check': ('run one exam on the files of a package', check.options, check.run),
    'sample-class': (
        'write the bundled example submissions',
        authoring.sample_options,
        authoring.sample_class,
    ),
    'self-check': (
        'grade the reference solution and the bare release of every lesson',
        lambda parser: None,
        authoring.self_check,
    ),
    'run': ('run exams on one script, package, zip or notebook', run.options, run.run),
    'collect': (
        'take in a class from a folder, a zip of an LMS or an exchange',
        collect.options,
        collect.run,
    ),
    'rejudge': (
        'new verdicts from the kept recordings after an exam edit; runs nothing',
        rejudge.options,
        rejudge.run,
    ),
    'forget': (
        'show what the course has of a student; with --yes, remove it',
        forget.options,
        forget.run,
    ),
    'explain': ('show the evidence behind a verdict', explain.options, explain.run),
    'report': (
        'write the page of a class in numbers again',
        stats.report_options,
        stats.report,
    ),
    'stats': ('the last grading in numbers: marks, checks, causes', stats.options, stats.run),
    'similar': ('list similar submissions to look at', similar.options, similar.run),
    'export': ('the last grading for other programs', export.options, export.run),
    'new-course': (
        'begin another course in a folder of its own',
        authoring.course_options,
        authoring.new_course,
    ),
    'new-exam': (
        'begin an exercise: its lesson and its two exams',
        authoring.exam_options,
        authoring.new_exam,
    ),
}
"""By name: the line of help, what describes the options, and what runs."""
GOES_ON = {
    'grade': 'Finished runs are kept; the same command goes on.',
    'collect': 'What was taken stays; the same command goes on.',
}
"""Commands of which something is kept if they are stopped."""
OURS = ('autograder', 'drawing', 'environment', 'roslab')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    :param arguments: the command line without the program
    :returns: the exit code
    """
    chosen = _parser().parse_args(arguments)
    if chosen.course:
        os.environ[CHOSEN] = str(chosen.course.resolve())
    try:
        code: int = chosen.run(chosen)
        sys.stdout.flush()
    except check.REFUSALS as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            end_runs()
            return UNREAD
        if isinstance(error, ModuleNotFoundError) and str(error.name).partition('.')[0] in OURS:
            raise  # a defect of ours, not of the Python in use
        check.refuse(error, chosen.command == 'check' and chosen.json)
        return USAGE
    except KeyboardInterrupt:
        print(f'\nStopped. {_how_to_go_on(chosen)}', file=sys.stderr)
        if not end_runs():
            os._exit(STOPPED)
        return STOPPED
    return code


def _nobody_reads() -> bool:
    """
    Return whether standard output is a pipe that its reader has closed.

    If so it is led away, or Python itself would complain at its end.
    """
    try:
        output = sys.stdout.fileno()
    except (OSError, ValueError):  # no file of the system's
        return False
    looked_at = select.poll()
    looked_at.register(output, 0)  # errors are always reported
    if not any(what & select.POLLERR for _, what in looked_at.poll(0)):
        return False
    os.dup2(os.open(os.devnull, os.O_WRONLY), output)
    return True


def _how_to_go_on(chosen: argparse.Namespace) -> str:
    """Say what is kept of a command that was stopped."""
    if chosen.command not in GOES_ON:
        return 'The same command begins again.'
    if getattr(chosen, 'fresh', False):
        return (
            'What was reported is done. The same command begins again, as --fresh repeats every '
            'run; --assignment NAME limits it to what is missing.'
        )
    return GOES_ON[chosen.command]


def _parser() -> argparse.ArgumentParser:
    """Describe the command line."""
    parser = argparse.ArgumentParser(prog='python -m autograder', description=__doc__)
    parser.add_argument('--course', type=Path, metavar='DIR', help='folder with a course.toml')
    commands = parser.add_subparsers(required=True, metavar='COMMAND', dest='command')

    for name, (text, options, run_it) in COMMANDS.items():
        command = commands.add_parser(name, help=text)
        options(command)
        command.set_defaults(run=run_it)
    return parser


if __name__ == '__main__':
    sys.exit(main())
