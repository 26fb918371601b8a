"""
Print the evidence behind one verdict, for example after an appeal.

The evidence comes from the last results, the stored recording and the current submission.  The
check is judged once more, but no program runs.  The evidence contains hidden inputs, so it is for
the instructor, who decides what to show the student.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from difflib import get_close_matches
from hashlib import sha256
from pathlib import Path

from autograder.classroom.people import find_student
from autograder.classroom.results_of_class import graded
from autograder.classroom.standing import ADVICE, REVIEW, Standing, standings
from autograder.commands import OK, option, STUDENT, SUBMITTED, takes
from autograder.errors import GraderError, RecordingInvalid
from autograder.exam.exam import Check, Exam, Run
from autograder.explaining.feedback import points_of, printable
from autograder.explaining.live import live_line
from autograder.grading.examine import judge_again
from autograder.grading.pipeline import load_lesson, open_one
from autograder.judging.judge import deviation
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import CheckResult, ExamResult, shortened, SubmissionResult
from autograder.runs.version import files_digest
from autograder.submission.inbox import discover

BEFORE, AFTER, INPUTS = 6, 4, 3
LAST_WORDS = 4
MOST_LINES = 40
WIDEST = 120
HOW = {
    'named': 'the check reported its failure at this event',
    'cut': 'the recording up to this event already leads to this verdict',
    'ended': 'the run ended early here',
    'end': 'the end of the run; a shorter recording would not lead to this verdict',
}


@takes(
    STUDENT,
    option(
        'check',
        "name of the check, or EXAM/CHECK (default: list the student's checks)",
        metavar='CHECK',
        nargs='?',
    ),
    option('--assignment', 'needed if several assignments have this check', metavar='NAME'),
    SUBMITTED,
)
def run(chosen: argparse.Namespace) -> int:
    """Print the checks of a student, or the evidence behind one of them."""
    layout = Layout.here()
    if chosen.check is None:
        text = verdicts_text(standings_of(layout, chosen.student, chosen.assignment))
    else:
        where = chosen.assignment, chosen.submitted
        text = evidence(layout, chosen.student, chosen.check, *where)
    print(text)
    return OK


def evidence(
    layout: Layout,
    student: str,
    check: str,
    assignment: str | None = None,
    submitted: Path | None = None,
) -> str:
    """
    Return the evidence behind one verdict as plain text of at most :data:`MOST_LINES` lines.

    :param student: id or display name
    :param check: name of the check, or ``exam/check``
    :param assignment: with or without its number; needed if several assignments have the check
    :param submitted: the folder of the class; None for the default folder
    :raises GraderError: if the student or the check is not in the last results
    """
    result, exam_result, verdict = _find(layout, student, check, assignment)
    student = result.student
    lesson = load_lesson(layout, result.assignment)
    exam = next((one for one in lesson.exams if one.name == exam_result.exam), None)
    if exam is None:
        raise GraderError(f'The exam {exam_result.exam} of this result no longer exists.')
    folder = submitted or layout.submitted
    files: Mapping[str, str] = {}
    now = f'cannot be judged again: no submission of {student} in {folder}; try --submitted'
    for submission in discover(folder, lesson.assignment, lesson.notebook, ()):
        if submission.student == student:
            files = lesson.files(open_one(submission, lesson))[exam.name].files
            now = _compare_with_now(layout, exam, verdict, files, exam_result)
    path = layout.recordings / exam.name / exam_result.recording
    recording = None
    with suppress(RecordingInvalid):
        recording = Recording.load(path) if exam_result.recording else None
    checked = next((one for one in exam.checks if one.name == verdict.check), None)
    again = bool(checked and checked.again)
    start = recording.again if recording and again else recording
    facts = {**verdict.facts, **({'waits for': verdict.waits_for} if verdict.waits_for else {})}
    digests = [f'{name} {_digest(text.encode())}' for name, text in files.items()]
    lines = [
        f'{student}, {result.assignment}, exam {exam.name}, check {verdict.check}',
        f'{verdict.verdict.value}, {points_of(verdict)} points: {verdict.title}',
        *(f'  {word}: {" ".join(text.split())}' for word, text in facts.items()),
        f'  {now}',
        '',
        *(['In the second start of the program:'] * bool(start and again)),
        *_events_around(exam, checked, files, start),
        '',
        *_last_words(start),
        f'files (SHA-256): {", ".join(digests) or "none"}',
        *_about(path, start, files),
        f'isolation: {exam_result.mode or "nothing was run"}',
        *(f'flag: {flag}' for flag in result.flags[:3]),
        'This output shows inputs of the hidden exam. Do not pass it on to students unedited.',
    ]
    return _narrow(lines, MOST_LINES)


def standings_of(
    layout: Layout, student: str, assignment: str | None = None
) -> list[tuple[str, Standing]]:
    """
    Return the state of one student's work in each graded assignment, with the assignment.

    :param student: id or display name
    :param assignment: the only assignment to include; None for all
    :raises GraderError: if there is no such student
    """
    found = [
        (one.assignment, standing)
        for one in graded(layout, assignment)
        for standing in standings(layout, one.assignment, one.results)
    ]
    name = find_student(layout, student, {one.student for _, one in found})
    return [(where, one) for where, one in found if one.student == name]


def _find(
    layout: Layout, student: str, check: str, assignment: str | None
) -> tuple[SubmissionResult, ExamResult, CheckResult]:
    of_student = standings_of(layout, student, assignment)
    every = [
        (f'{exam.exam}/{verdict.check}', (one.result, exam, verdict))
        for _, one in of_student
        if one.result
        for exam in one.result.exams
        for verdict in exam.checks
    ]
    if not every:
        raise GraderError(verdict_lines(*of_student[0])[0])
    found = [(name, one) for name, one in every if f'/{name}'.endswith(f'/{check}')]
    if len(found) == 1:
        return found[0][1]
    if found:
        names = ', '.join(name for name, _ in found)
        raise GraderError(
            f'{check}: several checks have this name: {names}.', 'Try: name one of them'
        )
    raise GraderError(
        f'{check}: {student} has no check with this name.',
        _advice(check, [one for one, _ in every]),
    )


def _advice(check: str, names: Sequence[str]) -> str:
    """Return which checks an unknown name may mean: those of the exam, else similar ones."""
    of_exam = [name for name in names if name.startswith(f'{check.rstrip("/")}/')]
    parts = {part: name for name in names for part in (name, name.partition('/')[2])}
    close = dict.fromkeys(parts[one] for one in get_close_matches(check, parts, cutoff=0.5))
    if fitting := of_exam or [*close]:
        return f'Try: name one of {", ".join(fitting)}'
    return 'Try: explain STUDENT, which lists all checks of the student'


def _compare_with_now(
    layout: Layout,
    exam: Exam,
    verdict: CheckResult,
    files: Mapping[str, str],
    exam_result: ExamResult,
) -> str:
    """Judge the check once more and return a sentence that compares the verdicts."""
    result, why = judge_again(layout.recordings, exam, files, exam_result)
    if result is None:
        return f'cannot be judged again: {why}'
    check = next((one for one in result.checks if one.check == verdict.check), None)
    if check is None:
        return 'the exam no longer has this check'
    same = (check.verdict, check.points) == (verdict.verdict, verdict.points)
    said = 'same verdict' if same else f'{check.verdict.value}, {points_of(check)} points'
    return f'judged again now from the recording: {said}'


def _events_around(
    exam: Exam, check: Check | None, files: Mapping[str, str], recording: Recording | None
) -> Iterator[str]:
    """Yield the first deviation, the events around it, and the last inputs before it."""
    events = recording.events if recording else ()
    seen = [number for number, event in enumerate(events) if live_line(event)]
    if not recording or not seen:
        yield (
            'No recording: nothing was run, so the files alone gave the verdict, or the recording '
            'was deleted.'
        )
        return
    where = deviation(check, Run(files, recording, exam.facts)) if check else None
    if where is None:
        yield 'No deviation; the run begins with:'
        shown = seen[: BEFORE + AFTER]
    else:
        yield f'First deviation: {HOW[where.how]}.'
        before = [one for one in seen if one <= where.index]
        inputs = [one for one in before if events[one]['event'] == 'input']
        after = [one for one in seen if one > where.index]
        shown = sorted({*inputs[-INPUTS:], *before[-BEFORE - 1 :], *after[:AFTER]})
    for one in shown:
        yield f'{">" if where and one == where.index else " "} {live_line(events[one])}'


def _last_words(recording: Recording | None) -> Iterator[str]:
    """Yield the last lines that a program printed whose run ended early."""
    if not recording or recording.end_reason == 'complete':
        return
    # Prefer stderr, which usually explains more, unless it is empty.
    texts = [str(recording.process.get(name, '')) for name in ('stderr', 'stdout')]
    said = next((text for text in texts if text.strip()), '')
    if lines := [line for line in said.splitlines() if line.strip()]:
        yield 'last lines that the program printed:'
        yield from (f'  | {line}' for line in lines[-LAST_WORDS:])
        yield ''


def _about(path: Path, recording: Recording | None, files: Mapping[str, str]) -> Iterator[str]:
    """Yield the origin of a recording."""
    if not recording:
        return
    header = recording.header
    of_these = header.get('files') == files_digest(files)
    made = 'made from these files' if of_these else 'made from OTHER files'
    versions = header.get('made_with', {})
    made_with = ', '.join(f'{name} {text}' for name, text in versions.items())
    yield f'recording: {path.name}, SHA-256 {_digest(path.read_bytes())}, {made}'
    yield (
        f'  {len(recording.events)} events, end: {recording.end_reason}, {made_with}, '
        f'environment {str(header.get("environment", "unknown"))[:12]}'
    )


def _digest(data: bytes) -> str:
    """Return the first digits of the SHA-256 digest of some data."""
    return sha256(data).hexdigest()[:12]


def verdicts_text(found: Sequence[tuple[str, Standing]]) -> str:
    """Return the checks of one student, one per line, as plain text."""
    lines = [line for where, one in found for line in verdict_lines(where, one)]
    if len(lines) > len(found):
        lines.append('To see the evidence behind a verdict: explain STUDENT EXAM/CHECK')
    return printable('\n'.join(lines))


def verdict_lines(assignment: str, one: Standing) -> list[str]:
    """Return the state of a student's work and, if it has points, a line for each check."""
    result = one.result
    points = f'{points_of(result)} points' if result and not result.review else ''
    for_review = f'{one.status}: {one.reason}' if one.status == REVIEW else one.reason
    advice = f'Try: {ADVICE[one.status]}' if one.status in ADVICE else ''
    said = '. '.join(filter(None, (points, for_review.rstrip('.'), advice)))
    lines = [f'{one.student}{f" ({one.person})" * bool(one.person)}, {assignment}: {said}']
    for exam in result.exams if result and points else ():
        for check in exam.checks:
            head = f'  {check.verdict.value:7} {points_of(check):>9}  {exam.exam}/{check.check}'
            lines.append(_narrow([f'{head}  {check.cause}' if check.cause else head]))
    return lines


def _narrow(lines: Sequence[str], most: int | None = None) -> str:
    """Return text with lines of limited length and without control characters."""
    short = [shortened(line, WIDEST) for line in printable('\n'.join(lines)).split('\n')]
    return '\n'.join(short[:most])
