"""
Find mistakes in exams before a class is graded, also by grading the course's own notebooks.

An exam validates its own scenario when it is created, for example that each step names a known
topic.  ``release --check`` and ``self-check`` test the rest: whether message types exist and can
hold the values (this needs an installed ROS), and whether the sections to read exist.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from difflib import get_close_matches
import json
import os
from pathlib import Path
import subprocess
from typing import Any

from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.explaining.feedback_html import named_section
from autograder.gradebook.record import points_mismatches
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_opened, Lesson, load_lesson
from autograder.layout import Layout, lesson_files
from autograder.results import SubmissionResult
from autograder.submission.notebook import read_release
from autograder.submission.submission import open_submission
from environment.ros import ros_environment

SECRETS = 200
"""Number of different secrets for which the drawn inputs of an exam are tested."""
LONGEST = 300
"""Maximum length of the inputs in a message [characters]."""
ADVICE = 'Try: correct the exam, or add the missing package to environment/messages.txt'


# -- with an installed ROS ------------------------------------------------------------------


def unsendable(exams: Iterable[Exam]) -> list[str]:
    """
    Return types that are not installed, and messages that the probe cannot send, one line each.

    The probe's own code tests all of them, in one separate process that imports ROS.

    :raises GraderError: if this process cannot use ROS
    """
    places: list[str] = []
    pairs: list[tuple[str, Mapping[str, Any] | None]] = []
    starts = (
        (exam.name + ', again' * later, start)
        for exam in exams
        for later, start in enumerate(exam.scenario.starts)
    )
    for name, start in starts:
        types: dict[str, str] = {}
        for place, topic, kind in start.types():
            types[topic] = kind
            places.append(f'exam {name}, {place}')
            pairs.append((kind, None))
        for place, step in start.placed():
            for part, kind, values in step.sends():
                places.append(f'exam {name}, {place}{part}')
                pairs.append((types.get(kind, kind), values))
    if not pairs:
        return []
    ros = ros_environment()
    probe = Path(__file__).parents[1] / 'probe'
    done = subprocess.run(
        [ros.python, str(Path(__file__).with_name('exam_values.py')), str(probe)],
        input=json.dumps(pairs, default=repr),  # The probe sends only JSON values.
        env={**os.environ, **ros.variables, 'ROS_PYTHON_CHECK_FIELDS': '1'},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        said = (done.stderr.splitlines() or ['no reason given'])[-1]
        raise GraderError(f'{ros.python}: cannot use ROS: {said}.', 'Try: make doctor')
    return [
        f'{place}: {problem}. {ADVICE}'
        for place, problem in zip(places, json.loads(done.stdout))
        if problem
    ]


def differs_from_visible(exam: Exam, visible: Exam) -> Iterator[str]:
    """Yield one line for each field that must equal that of the visible exam but differs."""
    for what in ('cells', 'requires', 'part', 'assignment'):
        if getattr(exam, what) != getattr(visible, what):
            yield (
                f'exam {exam.name}: expected the same {what} as in the visible exam, '
                f'{getattr(visible, what)!r}, got {getattr(exam, what)!r}'
            )


def inseparable_slips(exam: Exam) -> Iterator[str]:
    """
    Yield slips that some drawn inputs cannot distinguish from correct answers or other slips.

    With these inputs, a program with such a slip would get full marks or a wrong cause.
    """
    seen: dict[str, str] = {}
    for number in range(SECRETS if exam.asks else 0):
        other = catalog.load_with_secret(exam.name, f'secret {number}')
        for name, asked in other.asks.items():
            for mistake in asked.mistakes():
                inputs = ', '.join(map(repr, asked.inputs))[:LONGEST]
                seen.setdefault(f'{name}: {mistake}', f"'secret {number}'; inputs: {inputs}")
    for mistake, where in seen.items():
        yield f'exam {exam.name}, {mistake}; found with COURSE_SECRET={where}'


# -- with the lessons -----------------------------------------------------------------------


def read_mistakes(exam: Exam, headings: Mapping[str, AbstractSet[str]]) -> Iterator[str]:
    """
    Yield checks that name no section to read, or a section that does not exist.

    :param headings: headings by lesson, see :func:`lesson_headings`; if the exam's own lesson is
        missing, the function only tests that a section is named
    """
    for check in exam.checks:
        where, section = f'exam {exam.name}, check {check.name}', check.read or exam.read
        if not section.strip():
            yield f'{where}: expected a section to read, got none'
        elif exam.assignment in headings and (
            problem := no_section(section, exam.assignment, headings)
        ):
            yield f'{where}: {problem}'


def no_section(section: str, lesson: str, headings: Mapping[str, AbstractSet[str]]) -> str:
    """
    Return what is wrong with a section to read, empty if the section exists.

    :param section: section to read, as for :func:`named_section`
    :param lesson: the lesson to search if the section names no lesson
    """
    number, heading = named_section(section)
    if number:
        lesson = next((name for name in sorted(headings) if name.startswith(f'{number}_')), '')
        if not lesson:
            return f'expected a lesson to read, got {section!r}: there is no lesson {number}'
    if not heading or heading in headings[lesson]:
        return ''
    close = get_close_matches(heading, headings[lesson], n=1, cutoff=0.6)
    hint = f'; did you mean {close[0]!r}?' if close else ''
    return f'expected a heading of {lesson} to read, got {heading!r}{hint}'


def lesson_headings(notebooks: Path) -> dict[str, AbstractSet[str]]:
    """Return the headings of every readable lesson in a folder, by the lesson's folder name."""
    found: dict[str, AbstractSet[str]] = {}
    for path in lesson_files(notebooks):
        try:
            cells = read_release(path)['cells']
        except (OSError, ValueError):
            continue  # Unreadable notebooks are not the subject of this check.
        texts = [cell['source'] for cell in cells if cell['cell_type'] == 'markdown']
        lines = '\n'.join(texts).splitlines()
        titles = {line.lstrip('#').strip() for line in lines if line.startswith('#')}
        found[path.parent.name] = titles
    return found


# -- all mistakes ---------------------------------------------------------------------------


def mistakes_of(exams: Sequence[Exam], notebooks: Path) -> list[str]:
    """Return the mistakes in hidden exams that can be found without a run, one line each."""
    found, headings = unsendable(exams), lesson_headings(notebooks)
    for exam in exams:
        file = exam.scenario.file
        if exam.scenario.program == 'node' and file not in exam.requires:
            found.append(f'exam {exam.name}: runs {file!r}, which it does not require')
        found += read_mistakes(exam, headings)
        found += inseparable_slips(exam)
        found += differs_from_visible(exam, catalog.load(exam.name, hidden=False))
    return found


# -- with runs ------------------------------------------------------------------------------


def self_check(layout: Layout, engine: Engine) -> Iterator[tuple[bool, str]]:
    """
    Grade the reference solution, which must pass, and the untouched release, which must fail.

    The set-up does this as its last step; authors do it after they edit an exam.  The recordings
    are stored, so a later grading can use them.

    :returns: for each of them, whether the result is as expected, and one line of text
    :raises GraderError: if the course has an error or the grader fails
    """
    for assignment in layout.assignments():
        lesson = load_lesson(layout, assignment, engine)
        # Do not run an exam with a mistake, because the run may fail or hang.
        exams = [exam for exam in lesson.exams if isinstance(exam, Exam)]
        if mistakes := mistakes_of(exams, layout.notebooks):
            yield from ((False, f'{assignment}: {line}') for line in mistakes)
            continue
        if not lesson.exams:
            cells = list(points_mismatches(lesson.release, assignment, ()))
            yield not cells, ' '.join(cells) or f'{assignment}: nothing to grade, as expected.'
            continue
        for name, path, share in (
            ('the reference solution', layout.solutions / assignment / lesson.notebook, 1.0),
            ('the untouched release', layout.release(assignment), 0.0),
        ):
            opened = open_submission(path.read_bytes(), lesson.release, lesson.notebook)
            result = grade_opened(opened, name, lesson, engine)
            yield _line(lesson, result, share * result.max_points)


def _line(lesson: Lesson, result: SubmissionResult, wanted: float) -> tuple[bool, str]:
    if result.fault:  # Without a verdict, there are no points to compare.
        return False, f'{lesson.assignment}: {result.student} has no verdict. {result.fault}'
    right = bool(result.exams) and result.points == wanted
    text = f'{lesson.assignment}: {result.student} has {result.points:g} of {result.max_points:g}'
    if right:
        return True, f'{text}, as expected.'
    why = ', '.join(
        f'{exam.exam}/{check.check}: {check.verdict.value}'
        for exam in result.exams
        for check in exam.checks
        if (check.points > 0) != (wanted > 0)
    )
    return False, f'{text}, expected {wanted:g}. {why}'
