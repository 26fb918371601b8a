"""Check the rules for all feedback: it is short, discreet and impartial."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from autograder.exam.exam import Exam
from autograder.explaining.feedback import causes_once, check_lines, MOST_LINES, WIDTH
from autograder.grading.examine import judge_recording
from autograder.recording import Recording
from autograder.results import ExamResult, Verdict
from tests.judgement.drawn_inputs import revealed_values, texts_of
from tests.judgement.rewritten import blanked, commented, rewritten


def unreadable(result: ExamResult) -> Iterator[str]:
    """Yield the checks whose text is too long or too wide, or that fail without an explanation."""
    for check in causes_once(result):
        lines = check_lines(check)
        silent = check.verdict is not Verdict.PASSED and len(lines) < 2
        if silent or len(lines) > MOST_LINES or max(map(len, lines)) > WIDTH:
            yield f'{check.check}: {lines}'


def revealed_inputs(exam: Exam, result: ExamResult) -> Iterator[str]:
    """Yield the inputs that failed checks reveal: a student could hard-code them and resubmit."""
    for check in result.failed:
        if revealed := revealed_values(exam, texts_of(check)):
            yield f'{check.check}: reveals {revealed}'


def _without_lines(recording: Recording) -> Recording:
    return replace(recording, events=[{**event, 'line': None} for event in recording.events])


def moved_by_text(exam: Exam, files: Mapping[str, str], recording: Recording) -> Iterator[str]:
    """Yield checks whose points depend on the program's text, or whose causes on its style."""
    # The line numbers in the feedback are those of the text that ran.
    again = recording.again and _without_lines(recording.again)
    recording = replace(_without_lines(recording), again=again)
    due, silent = (judge_recording(exam, text, recording) for text in (files, blanked(files)))
    for check, other in zip(due.checks, silent.checks):
        if check.points != other.points:
            yield f'{check.check}: other points without the text'
    ways = [commented]
    if not any('Traceback' in str(one.process.get('stderr', '')) for one in recording.starts):
        ways.append(rewritten)
    for way in ways:
        for check, other in zip(due.checks, judge_recording(exam, way(files), recording).checks):
            if (check.points, check.cause_id) != (other.points, other.cause_id):
                yield f'{check.check}: {check.cause_id}, but {other.cause_id} if {way.__name__}'
