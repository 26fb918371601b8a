"""
Grade a course of ROS 2 exercises; COMMAND --help lists the options of COMMAND.

Exit codes: 0 success, 1 some work is for review, was left out or failed a self-check, 2 the
command failed (wrong arguments, or a fault of the grader), 130 stopped with Ctrl-C.
"""

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
from pkgutil import resolve_name
import select
import sys

from autograder.commands import describe, STOPPED, UNREAD, USAGE
from autograder.commands.check import REFUSALS, refuse
from autograder.grading.pipeline import end_runs
from autograder.layout import CHOSEN

COMMANDS = {
    'grade': ('grade:run', 'grade a class and write reports'),
    'check': ('check:run', 'run one exam on the files of a package'),
    'sample-class': (
        'authoring:sample_class_command',
        'write the example submissions to a folder',
    ),
    'release': (
        'authoring:release_command',
        'generate notebooks/ from solutions/, check the course, pack the files for students',
    ),
    'self-check': (
        'authoring:self_check_command',
        'check that reference solutions pass and untouched notebooks do not',
    ),
    'run': ('run:run', 'run exams on one script, package, zip file or notebook'),
    'collect': (
        'collect:run',
        'import submissions from a folder, a zip file from an LMS, or an exchange',
    ),
    'rejudge': (
        'rejudge:run',
        'judge stored recordings again with the edited exam, without running programs',
    ),
    'forget': ('forget:run', 'list all data about a student; --yes removes it'),
    'explain': ('explain:run', 'show the evidence behind a verdict'),
    'stats': ('stats:run', 'print statistics of the last grading: marks, checks, causes'),
    'similar': ('similar:run', 'list similar submissions for you to compare'),
    'export': ('export:run', 'export the results of the last grading'),
    'new-course': ('authoring:new_course_command', 'create a new course in a separate folder'),
    'new-exam': (
        'authoring:new_exam_command',
        'create an exercise: a lesson and its two exams',
    ),
}
"""Commands by name: the function, as MODULE:NAME in ``autograder.commands``, and the help text."""
GOES_ON = {
    'grade': 'Finished runs are kept; run the same command again to continue.',
    'collect': 'Collected files are kept; run the same command again to continue.',
}
"""Advice after Ctrl-C, for the commands that keep their progress."""
OURS = ('autograder', 'drawing', 'environment', 'roslab')


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, given without the program, and return its exit code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    chosen = argparse.Namespace(command='')
    try:
        chosen = _parser(arguments).parse_args(arguments)
        if chosen.course:
            os.environ[CHOSEN] = str(chosen.course.resolve())
        code: int = chosen.run(chosen)
        sys.stdout.flush()
    except REFUSALS as error:
        if isinstance(error, BrokenPipeError) and _is_reader_gone():
            end_runs()
            return UNREAD
        if isinstance(error, ModuleNotFoundError) and str(error.name).partition('.')[0] in OURS:
            raise  # a missing module of the project is a defect, not an environment problem
        refuse(error, chosen.command == 'check' and chosen.json)
        return USAGE
    except KeyboardInterrupt:
        print(f'\nStopped. {_continuation_advice(chosen)}', file=sys.stderr)
        if not end_runs():
            os._exit(STOPPED)
        return STOPPED
    return code


def _is_reader_gone() -> bool:
    """
    Return whether standard output is a pipe that its reader has closed.

    If so, redirect it to /dev/null; otherwise Python would report an error when it exits.
    """
    try:
        output = sys.stdout.fileno()
    except (OSError, ValueError):  # standard output has no file descriptor
        return False
    looked_at = select.poll()
    looked_at.register(output, 0)  # poll() always reports errors
    if not any(what & select.POLLERR for _, what in looked_at.poll(0)):
        return False
    os.dup2(os.open(os.devnull, os.O_WRONLY), output)
    return True


def _continuation_advice(chosen: argparse.Namespace) -> str:
    """Return a message that says what a stopped command has kept and how to continue."""
    if chosen.command not in GOES_ON:
        return 'Run the same command again; it starts from the beginning.'
    if getattr(chosen, 'fresh', False):
        return (
            'Assignments with a summary above are done. With --fresh, the same command repeats '
            'every run; add --assignment NAME to grade only one assignment.'
        )
    return GOES_ON[chosen.command]


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the command-line parser, with only the options of the requested command."""
    parser = argparse.ArgumentParser(prog='autograder', description=__doc__)
    parser.add_argument(
        '--course',
        type=Path,
        metavar='DIR',
        help='folder with a course.toml (default: the course that contains the current folder)',
    )
    commands = parser.add_subparsers(required=True, metavar='COMMAND', dest='command')

    for name, (run, text) in COMMANDS.items():
        command = commands.add_parser(name, help=text)
        if name in arguments:  # do not import the modules of other commands
            made = resolve_name(f'autograder.commands.{run}')
            describe(command, made)
            command.set_defaults(run=made)
    return parser


if __name__ == '__main__':
    sys.exit(main())
