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

from autograder.commands.check import describe, REFUSALS, refuse
from autograder.commands.collect import add_collect
from autograder.commands.exit_codes import FOR_REVIEW, OK, STOPPED, UNREAD, USAGE
from autograder.commands.explain import add_explain
from autograder.commands.export import add_class_commands
from autograder.commands.forget import add_forget
from autograder.commands.grade import add_grade, short
from autograder.commands.new import add_new
from autograder.commands.rejudge import add_rejudge
from autograder.commands.run import add_run
from autograder.grading.pipeline import end_runs
from autograder.layout import CHOSEN, Layout

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
    except REFUSALS as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            end_runs()
            return UNREAD
        if isinstance(error, ModuleNotFoundError) and str(error.name).partition('.')[0] in OURS:
            raise  # a defect of ours, not of the Python in use
        refuse(error, chosen.command == 'check' and chosen.json)
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

    add_grade(commands)
    describe(commands.add_parser('check', help='run one exam on the files of a package'))

    sample = commands.add_parser('sample-class', help='write the bundled example submissions')
    sample.add_argument('--to', type=Path, metavar='DIR', help='default: the submitted folder')
    sample.set_defaults(run=_sample_class)

    proof = commands.add_parser(
        'self-check', help='grade the reference solution and the bare release of every lesson'
    )
    proof.set_defaults(run=_self_check)
    for add in (add_run, add_collect, add_rejudge, add_forget, add_explain):
        add(commands)
    add_class_commands(commands)
    add_new(commands)
    return parser


def _self_check(chosen: argparse.Namespace) -> int:
    """Show that the reference passes every exam here and that the bare release does not."""
    from autograder.authoring.self_check import self_check
    from autograder.grading.pipeline import grading_engine

    layout = Layout.here()
    code = OK
    for right, line in self_check(layout, grading_engine(layout)):
        print(line, flush=True)
        code = code if right else FOR_REVIEW
    return code


# -- sample-class ---------------------------------------------------------------------------


def _sample_class(chosen: argparse.Namespace) -> int:
    """Write the bundled class."""
    from autograder.authoring.sample_class import write_sample_class

    layout = Layout.here()
    folder = (chosen.to or layout.submitted).resolve()
    count = write_sample_class(layout, folder)
    print(f'{count} submissions are in {short(folder, layout)}.')
    return OK


if __name__ == '__main__':
    sys.exit(main())
