"""
Run the visible checks of the notebooks in a student's repository.

    python -m autograder.workflow [LESSON ...]

GitHub Actions runs this on every push. Exit code 0: every check has a verdict, 2: the checks could
not be run. Classroom's reporter decides from the points whether the job passes.
"""

import argparse
from collections.abc import Iterator, Sequence
import os
from pathlib import Path
import sys

from autograder.commands import OK, USAGE
from autograder.commands.check import REFUSALS, refuse, sandbox_for
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.explaining.feedback import printable
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.submission.cells import UNSOLVED
from autograder.submission.notebook import marks_of, read_release
from autograder.submission.package import name_missing
from autograder.submission.submission import files_in_notebook
from autograder.workflow.report import Checked, classroom_result, error_commands, summary


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the checks, print the annotations, and write the summary and the points for GitHub."""
    parser = argparse.ArgumentParser(prog='python -m autograder.workflow')
    parser.add_argument('lessons', nargs='*', metavar='LESSON', help='lesson (default: all)')
    chosen = parser.parse_args(arguments)
    try:
        layout = Layout.here()
        lessons = [layout.assignment_named(one) for one in chosen.lessons]
        found = list(
            checked(layout, lessons or layout.assignments(), Engine(sandbox_for(visible=True)))
        )
    except REFUSALS as error:
        refuse(error, as_json=False)
        return USAGE
    print('\n'.join(error_commands(found)))
    _append('GITHUB_STEP_SUMMARY', summary(found))
    _append('GITHUB_OUTPUT', f'result={classroom_result(found)}\n')
    return OK


def checked(layout: Layout, lessons: Sequence[str], engine: Engine) -> Iterator[Checked]:
    """Yield the outcome of each exam; an exercise that was not attempted is not run."""
    for lesson in lessons:
        if exams := catalog.for_assignment(lesson, hidden=False):
            path = layout.release(lesson)
            try:
                yield from _of_notebook(path, exams, layout, engine)
            except (ValueError, LookupError, TypeError) as error:
                name = path.relative_to(layout.root).as_posix()
                said = f'the notebook cannot be read ({type(error).__name__})'
                yield from (_unwritten(name, exam, engine, (said,)) for exam in exams)


def _of_notebook(
    path: Path, exams: Sequence[Exam], layout: Layout, engine: Engine
) -> Iterator[Checked]:
    """Yield the outcome of each exam of a notebook."""
    name = path.relative_to(layout.root).as_posix()
    release = read_release(path)  # the student's copy, because the repository has no other
    text = path.read_text(encoding='utf-8', errors='replace')
    sources = {marks_of(cell).get('grade_id'): cell['source'] for cell in release['cells']}
    for exam, found in files_in_notebook(path, release, exams):
        if not found.problems and any(UNSOLVED in one for one in found.files.values()):
            yield _unwritten(name, exam, engine)
            continue
        result = engine.run(exam, found.files)
        result = result if found.problems else name_missing(result, found.files)
        source = next((sources[cell] for cell in exam.cells if cell in sources), '')
        problems = tuple(printable(problem.line()) for problem in found.problems)
        yield Checked(name, text, source, True, result, problems)


def _unwritten(name: str, exam: Exam, engine: Engine, problems: tuple[str, ...] = ()) -> Checked:
    """Return an outcome without a run and without points, because there is no file."""
    return Checked(name, '', '', False, engine.run(exam, {}), problems)


def _append(variable: str, text: str) -> None:
    """Append text to the file that GitHub names in a variable; without a file, do nothing."""
    if path := os.environ.get(variable):
        with Path(path).open('a', encoding='utf-8') as file:
            file.write(text)


if __name__ == '__main__':
    sys.exit(main())
