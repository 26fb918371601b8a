"""
Pack the course as an autograder for Gradescope, and write ``results.json`` in its container.

``setup.sh`` and ``run_autograder`` are at the root of the zip; the rest is the course without its
submissions.  The zip includes the course secret, so that hidden inputs are the same on Gradescope.
It must therefore be kept as secret as the hidden exams.  The README in the zip describes what the
container must allow: without user namespaces only weaker isolation works, and the grader uses it
only if ``--allow-weak`` names it.

``results.json`` has a score for each test, and their sum.  Text from students is always shown as
plain text, never as HTML.  Only instructors see the standard output of the grader.  By default,
students see the tests of the hidden exam when grades are published.  If they saw the tests
earlier, they could submit many times to find out what is tested.
"""

from collections.abc import Iterator, Sequence
import json
from pathlib import Path
import sys
from typing import Any

from autograder.classroom.results_of_class import missing_protections, modes, seconds_of_exam
from autograder.errors import GraderError
from autograder.exam.inputs import course_secret
from autograder.explaining.feedback import causes_once, number, printable
from autograder.exports.marks import automatic
from autograder.files import files_below, json_bytes, write_atomically, zip_bytes, zip_content
from autograder.grading.pipeline import grade_opened, grading_engine, load_lesson, open_one
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict
from autograder.sandboxes.isolation import MODES
from autograder.submission.inbox import open_folder
from environment.places import PROJECT

VISIBILITIES = ('after_published', 'after_due_date', 'visible', 'hidden')
RESULTS = 'results.json'
SETTINGS = 'gradescope.json'
EXECUTABLE = ('setup.sh', 'run_autograder')
HERE = Path(__file__).parent / 'gradescope_files'
ENGINE = ('autograder', 'drawing', 'environment', 'roslab', 'pyproject.toml')
"""Files and folders of this project that grading needs, in addition to the course's own files."""
LEFT_OUT = {'_work', '__pycache__', 'ros_ws'}


def autograder_zip(
    layout: Layout, assignment: str, visibility: str = VISIBILITIES[0], allow_weak: str = ''
) -> bytes:
    """
    Return the zip file as bytes.

    :param visibility: when students see the tests, one of :data:`VISIBILITIES`
    :param allow_weak: weakest isolation mode to accept in the container, see
        :mod:`autograder.sandboxes.isolation`; empty for full isolation only
    :raises GraderError: if hidden exams must not run with this mode, or this copy of the course
        has no hidden exams
    """
    if allow_weak and not MODES[allow_weak].keeps_secrets:
        raise GraderError(
            f'--allow-weak {allow_weak}: hidden exams never run with this isolation, so '
            'there would be no grades.'
        )
    if not (layout.exams / 'hidden').is_dir():
        raise GraderError(
            "The students' copy of the course has no hidden exams.",
            "Try: run this in the instructors' copy",
        )
    settings = {'assignment': assignment, 'visibility': visibility, 'allow_weak': allow_weak}
    paths = {path.name: path for path in HERE.iterdir()} | dict(course_files(layout))
    files = {name: zip_content(path) for name, path in paths.items()}
    files |= {name: (files[name][0], 0o755) for name in EXECUTABLE}  # a wheel may lose this bit
    files[SETTINGS] = json_bytes(settings), 0o644
    files[str(layout.secret.relative_to(layout.root))] = course_secret(), 0o600
    return zip_bytes(files)


def course_files(layout: Layout) -> Iterator[tuple[str, Path]]:
    """Yield the files that grading needs, each with its name in the zip."""
    own = {'course.toml', 'nbgrader_config.py', 'notebooks', 'solutions', 'exams'}
    own |= {layout.facts.package} - {''}
    parts = {**dict.fromkeys(ENGINE, PROJECT), **dict.fromkeys(own, layout.root)}
    for part, root in parts.items():
        for name, path in files_below(root, part, LEFT_OUT):
            if not any(one.startswith('.') for one in name.split('/')):
                yield name, path


def results_of(result: SubmissionResult, visibility: str = VISIBILITIES[0]) -> dict[str, Any]:
    """
    Return the content of ``results.json``.

    :raises GraderError: if there is no mark: Gradescope refuses a file without a score, but if the
        file is missing, it refers the student to the staff
    """
    mark = automatic(result)
    if mark.points is None:
        raise GraderError(
            f'{result.student}: {mark.status}, so there are no results.', result.review
        )
    return {
        'score': round(mark.points, 4),
        'execution_time': round(sum(map(seconds_of_exam, result.exams)), 2),
        'output': _about(result),
        'output_format': 'text',
        'test_output_format': 'text',
        'test_name_format': 'text',
        'visibility': visibility,
        'stdout_visibility': 'hidden',
        'tests': [
            _test(exam, check, f'{one}.{two}', visibility)
            for one, exam in enumerate(result.exams, start=1)
            for two, check in enumerate(causes_once(exam), start=1)
        ],
        'extra_data': {
            'assignment': result.assignment,
            'isolation': modes([result]),
            'recordings': {exam.exam: exam.recording for exam in result.exams if exam.recording},
            'flags': list(result.flags),
        },
    }


def _about(result: SubmissionResult) -> str:
    """Return the points and notes about the submission as a whole, for the student."""
    lines = [f'{number(result.points)} of {number(result.max_points)} points of automatic checks']
    lines += [problem.line() for problem in result.problems]
    lines += [f'{exam.exam}: {exam.note}' for exam in result.exams if exam.note]
    lines += [f'Run with weak isolation: {lack}.' for lack in missing_protections([result])]
    return printable('\n'.join(lines))


def _test(exam: ExamResult, check: CheckResult, place: str, visibility: str) -> dict[str, Any]:
    return {
        'name': printable(f'{exam.exam}: {check.title}'),
        'number': place,
        'score': round(check.points, 4),
        'max_score': round(check.max_points, 4),
        'status': 'passed' if check.verdict is Verdict.PASSED else 'failed',
        'output': printable(_output(check)),
        'output_format': 'text',
        'visibility': visibility,
    }


def _output(check: CheckResult) -> str:
    """Return the feedback on a check for the student; empty if it passed."""
    if check.verdict is Verdict.PASSED:
        return ''
    if check.verdict is Verdict.NOT_RUN:
        return f'Not checked, because it depends on: {check.waits_for}'
    return '\n'.join(f'{name.capitalize()}: {text}' for name, text in check.facts.items())


# -- in the container -----------------------------------------------------------------------


def main(arguments: Sequence[str]) -> int:
    """
    Grade ``ROOT/submission`` and, unless it is for review, write ``ROOT/results/results.json``.

    Without ``results.json``, Gradescope reports a failed autograder instead of giving a zero.

    :param arguments: one argument, the folder ROOT: ``/autograder`` in the container
    :returns: the exit code: 1 if there is no verdict
    """
    root = Path(arguments[0])
    results = root / 'results' / RESULTS
    results.unlink(missing_ok=True)
    try:
        layout = Layout.here()
        settings = json.loads((layout.root / SETTINGS).read_text(encoding='utf-8'))
        engine = grading_engine(layout, allow_weak=settings['allow_weak'])
        if not engine.hidden:
            raise GraderError('Only visible checks can run here, so there is no grade.')
        lesson = load_lesson(layout, settings['assignment'], engine)
        opened = open_one(open_folder(root / 'submission', 'submission', lesson.notebook), lesson)
        result = grade_opened(opened, 'submission', lesson, engine)
        write_atomically(results, json_bytes(results_of(result, settings['visibility'])))
    except GraderError as error:
        print(f'No verdict, so no score: {error}', flush=True)
        return 1
    for flag in result.flags:
        print(f'flag: {flag}')
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
