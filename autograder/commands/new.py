"""``new-course`` and ``new-exam``: files to begin with, and what to type next."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
import shlex
import sys
from typing import Any

from autograder.commands.exit_codes import OK
from autograder.layout import Layout


def add_new(commands: Any) -> None:
    """
    Describe the commands.

    :param commands: what :meth:`argparse.ArgumentParser.add_subparsers` returns
    """
    course = commands.add_parser('new-course', help='begin another course in a folder of its own')
    course.add_argument('folder', type=Path, metavar='DIR', help='new or empty')
    course.set_defaults(run=_new_course)
    exam = commands.add_parser('new-exam', help='begin an exercise: its lesson and its two exams')
    exam.add_argument('name', metavar='NAME', help='such as visitor_counter')
    exam.add_argument('--lesson', required=True, metavar='NN_NAME', help='such as 01_doors')
    exam.set_defaults(run=_new_exam)


def _new_course(chosen: argparse.Namespace) -> int:
    """Make the folder and say how it is prepared."""
    from autograder.authoring.new_course import new_course

    made = new_course(chosen.folder)
    print(f'{chosen.folder} is a course of {len(made)} files. Next, in that folder:')
    print(f'  {shlex.quote(sys.executable)} -m environment prepare')
    print('  .venv/bin/python -m autograder new-exam NAME --lesson 01_NAME')
    return OK


def _new_exam(chosen: argparse.Namespace) -> int:
    """Make the files and say how they are proven."""
    from autograder.authoring.new_course import new_exam

    course = Layout.here()
    for path in new_exam(course, chosen.name, chosen.lesson):
        print(os.path.relpath(course.root / path))
    print('They work as they are. Edit them, then:')
    print('  .venv/bin/python -m autograder.authoring.release release')
    print('  .venv/bin/python -m autograder self-check')
    return OK
