"""
Print the evidence behind one verdict, for example after an appeal.

The evidence comes from the last results, the stored recording and the current submission.  The
check is judged once more, but no program runs.  The evidence contains hidden inputs, so it is for
the instructor, who decides what to show the student.
"""

import argparse
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any

from autograder.classroom.pages import with_name
from autograder.classroom.people import read_people, student_named
from autograder.classroom.results_of_class import graded
from autograder.commands import JSON, OK, option, show, STUDENT, SUBMITTED, takes
from autograder.errors import GraderError, RecordingInvalid
from autograder.exam.exam import Exam, Run
from autograder.explaining.feedback import points_of, printable
from autograder.explaining.live import live_line
from autograder.exports.as_json import submission_json
from autograder.grading.examine import judge_again
from autograder.grading.pipeline import load_lesson, open_one
from autograder.judging.deviation import deviation
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
    JSON,
)
def run(chosen: argparse.Namespace) -> int:
    """Print the checks of a student, or the evidence behind one of them."""
    layout = Layout.here()
    if chosen.check is None:
        results = results_of(layout, chosen.student, chosen.assignment)
        as_json = [submission_json(result) for result in results]
        show(chosen.json, as_json, verdicts_text(layout, results))
        return OK
    found = evidence(layout, chosen.student, chosen.check, chosen.assignment, chosen.submitted)
    show(chosen.json, found, evidence_text(found))
    return OK


def evidence(
    layout: Layout,
    student: str,
    check: str,
    assignment: str | None = None,
    submitted: Path | None = None,
) -> dict[str, Any]:
    """
    Return the evidence behind one verdict as JSON data.

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
    return {
        'student': student,
        'assignment': result.assignment,
        'exam': exam.name,
        'fault': result.fault,
        'check': asdict(verdict),
        'now': now,
        'files': {name: sha256(text.encode()).hexdigest() for name, text in files.items()},
        'isolation': exam_result.mode,
        'flags': list(result.flags),
        'recording': _about(path, recording, files) if recording else None,
        **(_events_around(exam, verdict.check, files, recording) if recording else {}),
    }


def results_of(
    layout: Layout, student: str, assignment: str | None = None
) -> list[SubmissionResult]:
    """
    Return the last results of one student.

    :param student: id or display name
    :param assignment: the only assignment to include; None for all
    :raises GraderError: if the student is not in the last results
    """
    results = [result for one in graded(layout, assignment) for result in one.results]
    there = {result.student for result in results}
    if name := student_named(layout, student, there):
        return [result for result in results if result.student == name]
    raise GraderError(
        f'{student}: no student with this name or id has results.',
        f'Students with results: {", ".join(sorted(there)[:20])}.',
    )


def _find(
    layout: Layout, student: str, check: str, assignment: str | None
) -> tuple[SubmissionResult, ExamResult, CheckResult]:
    every = [
        (f'{exam.exam}/{verdict.check}', (result, exam, verdict))
        for result in results_of(layout, student, assignment)
        for exam in result.exams
        for verdict in exam.checks
    ]
    found = [(name, one) for name, one in every if f'/{name}'.endswith(f'/{check}')]
    if len(found) == 1:
        return found[0][1]
    names = ', '.join(name for name, _ in found or every)
    if found:
        raise GraderError(
            f'{check}: several checks have this name: {names}.', 'Try: name one of them'
        )
    raise GraderError(
        f'{check}: {student} has no check with this name.', f'Try: name one of {names}'
    )


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


def _about(path: Path, recording: Recording, files: Mapping[str, str]) -> dict[str, Any]:
    process = recording.process
    # Prefer stderr, which usually explains more, unless it is empty.
    texts = [str(process.get(name, '')) for name in ('stderr', 'stdout')]
    said = next((text for text in texts if text.strip()), '')
    return {
        'name': path.name,
        'sha256': sha256(path.read_bytes()).hexdigest(),
        'header': dict(recording.header),
        'events': len(recording.events),
        'end': recording.end_reason,
        'process': {
            name: value
            for name, value in process.items()
            if name not in ('event', 'stdout', 'stderr')
        },
        'of_these_files': recording.header.get('files') == files_digest(files),
        'said': [line for line in said.splitlines() if line.strip()][-LAST_WORDS:],
    }


def _events_around(
    exam: Exam, name: str, files: Mapping[str, str], recording: Recording
) -> dict[str, Any]:
    """Return the first deviation, the events around it, and the last inputs before it."""
    check = next((one for one in exam.checks if one.name == name), None)
    where = deviation(check, Run(files, recording, exam.facts)) if check else None
    events = recording.events
    seen = [number for number, event in enumerate(events) if live_line(event)]
    shown, moment = seen[: BEFORE + AFTER], None
    if where is not None:
        clock_ns = events[where.index].get('clock_ns')
        moment = {'index': where.index, 'clock_ns': clock_ns, 'how': HOW[where.how]}
        before = [one for one in seen if one <= where.index]
        inputs = [one for one in before if events[one]['event'] == 'input']
        after = [one for one in seen if one > where.index]
        shown = sorted({*inputs[-INPUTS:], *before[-BEFORE - 1 :], *after[:AFTER]})
    return {
        'deviation': moment,
        'seen': [
            {'index': one, 'line': live_line(events[one]), 'event': dict(events[one])}
            for one in shown
        ],
    }


# -- as text --------------------------------------------------------------------------------


def verdicts_text(layout: Layout, results: Sequence[SubmissionResult]) -> str:
    """Return the checks of one student, one per line, as plain text."""
    lines = []
    people = read_people(layout)
    for result in results:
        said = f'for review: {result.review}' if result.review else f'{points_of(result)} points'
        lines.append(f'{with_name(result.student, people)}, {result.assignment}: {said}')
        for exam in result.exams:
            for check in exam.checks:
                head = (
                    f'  {check.verdict.value:7} {points_of(check):>9}  {exam.exam}/{check.check}'
                )
                lines.append(f'{head}  {check.cause}' if check.cause else head)
    return _narrow([*lines, 'To see the evidence behind a verdict: explain STUDENT EXAM/CHECK'])


def evidence_text(found: Mapping[str, Any]) -> str:
    """Return the evidence as plain text of at most :data:`MOST_LINES` lines."""
    lines = [*_verdict_lines(found), '', *_seen_lines(found), '', *_origin_lines(found)]
    return _narrow(lines, MOST_LINES)


def _narrow(lines: Sequence[str], most: int | None = None) -> str:
    """Return text with lines of limited length and without control characters."""
    short = [shortened(line, WIDEST) for line in printable('\n'.join(lines)).split('\n')]
    return '\n'.join(short[:most])


def _verdict_lines(found: Mapping[str, Any]) -> list[str]:
    check = CheckResult.from_json(found['check'])
    facts = {**check.facts, **({'waits for': check.waits_for} if check.waits_for else {})}
    return [
        f'{found["student"]}, {found["assignment"]}, exam {found["exam"]}, check {check.check}',
        f'{check.verdict.value}, {points_of(check)} points: {check.title}',
        *(f'  {word}: {" ".join(text.split())}' for word, text in facts.items()),
        f'  {found["now"]}',
    ]


def _seen_lines(found: Mapping[str, Any]) -> list[str]:
    if not found.get('seen'):
        return [
            'No recording: nothing was run, so the files alone gave the verdict, or the recording '
            'was deleted.'
        ]
    where = found['deviation']
    head = f'First deviation: {where["how"]}.' if where else 'No deviation; the run begins with:'
    at = where['index'] if where else None
    return [
        head,
        *(f'{">" if one["index"] == at else " "} {one["line"]}' for one in found['seen']),
    ]


def _origin_lines(found: Mapping[str, Any]) -> list[str]:
    about, lines = found['recording'], []
    if about and about['end'] != 'complete' and about['said']:
        said = (f'  | {line}' for line in about['said'])
        lines = ['last lines that the program printed:', *said, '']
    files = ', '.join(f'{name} {digest[:12]}' for name, digest in found['files'].items())
    lines.append(f'files (SHA-256): {files or "none"}')
    if about:
        made = 'made from these files' if about['of_these_files'] else 'made from OTHER files'
        versions = about['header'].get('made_with', {})
        made_with = ', '.join(f'{name} {text}' for name, text in versions.items())
        lines += [
            f'recording: {about["name"]}, SHA-256 {about["sha256"][:12]}, {made}',
            f'  {about["events"]} events, end: {about["end"]}, {made_with}, '
            f'environment {str(about["header"].get("environment", "unknown"))[:12]}',
        ]
    lines.append(f'isolation: {found["isolation"] or "nothing was run"}')
    lines += [f'flag: {flag}' for flag in found['flags'][:3]]
    return [
        *lines,
        'This output shows inputs of the hidden exam. Do not pass it on to students unedited.',
    ]
