"""The commands for authors, such as ``new-course``, ``new-exam``, ``release``, ``self-check``."""

import argparse
import os
from pathlib import Path
import shlex
import sys

from autograder.authoring.exam_mistakes import self_check
from autograder.authoring.new_course import new_course, new_exam
from autograder.authoring.release import check, generate
from autograder.authoring.sample_class import write_sample_class
from autograder.authoring.student_bundle import pack
from autograder.commands import flag, FOR_REVIEW, OK, option, takes, TO_SUBMITTED
from autograder.commands.grade import relative_path
from autograder.errors import GraderError
from autograder.grading.pipeline import grading_engine
from autograder.layout import Layout


@takes(option('folder', 'folder to create, or an empty folder', type=Path, metavar='DIR'))
def new_course_command(chosen: argparse.Namespace) -> int:
    """Create the folder of a course and print the next commands."""
    made = new_course(chosen.folder)
    print(f'Created a course with {len(made)} files in {chosen.folder}. Next, run in that folder:')
    print(f'  {shlex.quote(sys.executable)} -m environment prepare')
    print('  .venv/bin/autograder new-exam NAME --lesson 01_NAME')
    return OK


@takes(
    option('name', 'name of the exam, such as visitor_counter', metavar='NAME'),
    option('--lesson', 'folder of the lesson, such as 01_doors', required=True, metavar='NN_NAME'),
)
def new_exam_command(chosen: argparse.Namespace) -> int:
    """Create the files of an exam and print the commands that test them."""
    course = Layout.here()
    for path in new_exam(course, chosen.name, chosen.lesson):
        print(os.path.relpath(course.root / path))
    print('Created these files; they already work. Edit them, then run:')
    print('  .venv/bin/autograder release')
    print('  .venv/bin/autograder self-check')
    return OK


@takes(
    flag('--check', 'only check that the files of the course agree; write nothing'),
    flag('--answers', 'let students see a worked answer after full points or three tries'),
)
def release_command(chosen: argparse.Namespace) -> int:
    """Generate the students' notebooks, check the course, and pack the files for students."""
    layout = Layout.here()
    if chosen.check:
        lines = check(layout)
        print('\n'.join(lines) or 'The notebooks and the exams agree.')
        return FOR_REVIEW if lines else OK
    if not (made := generate(layout, layout.notebooks)):
        raise GraderError(f'{layout.solutions}: expected ASSIGNMENT/NOTEBOOK.ipynb, got none.')
    if lines := check(layout):
        print('\n'.join(lines))
        print('Nothing was packed. Try: correct these mistakes, then release again.')
        return FOR_REVIEW
    bundle = layout.work / 'student_bundle.zip'
    count = pack(layout, bundle, chosen.answers)
    print(f'notebooks/ contains {", ".join(made)}.')
    print(f'{relative_path(bundle, layout)} contains {count} files for students.')
    return OK


@takes(TO_SUBMITTED, flag('--force', 'replace sample submissions that were changed'))
def sample_class_command(chosen: argparse.Namespace) -> int:
    """Write the example submissions of the sample class."""
    layout = Layout.here()
    folder = (chosen.to or layout.submitted).resolve()
    count = write_sample_class(layout, folder, chosen.force)
    print(f'Wrote {count} example submissions to {relative_path(folder, layout)}.')
    return OK


@takes()
def self_check_command(chosen: argparse.Namespace) -> int:
    """Check that the reference solution gets full points and the untouched release none."""
    layout = Layout.here()
    code = OK
    for right, line in self_check(layout, grading_engine(layout)):
        print(line, flush=True)
        code = code if right else FOR_REVIEW
    return code
