"""The commands for authors of a course: ``new-course``, ``new-exam``, ``sample-class``, ..."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
import shlex
import sys

from autograder.authoring.new_course import new_course, new_exam
from autograder.authoring.sample_class import write_sample_class
from autograder.authoring.self_check import self_check
from autograder.commands import FOR_REVIEW, OK
from autograder.commands.grade import short
from autograder.grading.pipeline import grading_engine
from autograder.layout import Layout


def new_course_options(parser: argparse.ArgumentParser) -> None:
    """Describe the options of ``new-course``."""
    parser.add_argument(
        'folder', type=Path, metavar='DIR', help='folder to create, or an empty folder'
    )
    parser.set_defaults(run=_new_course)


def _new_course(chosen: argparse.Namespace) -> int:
    """Create the folder and print how to prepare it."""
    made = new_course(chosen.folder)
    print(f'Created a course of {len(made)} files in {chosen.folder}. Next, in that folder:')
    print(f'  {shlex.quote(sys.executable)} -m environment prepare')
    print('  .venv/bin/python -m autograder new-exam NAME --lesson 01_NAME')
    return OK


def new_exam_options(parser: argparse.ArgumentParser) -> None:
    """Describe the options of ``new-exam``."""
    parser.add_argument('name', metavar='NAME', help='name of the exam, such as visitor_counter')
    parser.add_argument(
        '--lesson', required=True, metavar='NN_NAME', help='folder of the lesson, such as 01_doors'
    )
    parser.set_defaults(run=_new_exam)


def _new_exam(chosen: argparse.Namespace) -> int:
    """Create the files and print how to test them."""
    course = Layout.here()
    for path in new_exam(course, chosen.name, chosen.lesson):
        print(os.path.relpath(course.root / path))
    print('Created these files; they already work. Edit them, then:')
    print('  .venv/bin/python -m autograder.authoring.release release')
    print('  .venv/bin/python -m autograder self-check')
    return OK


def sample_class_options(parser: argparse.ArgumentParser) -> None:
    """Describe the options of ``sample-class``."""
    parser.add_argument(
        '--to',
        type=Path,
        metavar='DIR',
        help='folder to write to (default: autograder/_work/submitted)',
    )
    parser.set_defaults(run=_sample_class)


def _sample_class(chosen: argparse.Namespace) -> int:
    layout = Layout.here()
    folder = (chosen.to or layout.submitted).resolve()
    count = write_sample_class(layout, folder)
    print(f'Wrote {count} example submissions to {short(folder, layout)}.')
    return OK


def self_check_options(parser: argparse.ArgumentParser) -> None:
    """Describe the options of ``self-check``: it has none."""
    parser.set_defaults(run=_self_check)


def _self_check(chosen: argparse.Namespace) -> int:
    """Check that the reference passes every exam here and that the bare release does not."""
    layout = Layout.here()
    code = OK
    for right, line in self_check(layout, grading_engine(layout)):
        print(line, flush=True)
        code = code if right else FOR_REVIEW
    return code
