"""Cells of notebooks, and exams and an engine without programs, for tests of grading."""

from dataclasses import dataclass
import threading

from autograder.errors import ProbeFailed
from autograder.results import CheckResult, ExamResult, Verdict


def cell(grade_id='', source='', kind='code', **marks):
    """Return a cell of a notebook, with nbgrader's marks if it has a grade id."""
    metadata = {'nbgrader': {'grade_id': grade_id, **marks}} if grade_id else {}
    more = {'outputs': [], 'execution_count': None} if kind == 'code' else {}
    return {'cell_type': kind, 'metadata': metadata, 'source': source, **more}


def answer(text):
    """Return the answer cell of a talker."""
    return cell('talker', f'%%node talker\n{text}', solution=True)


@dataclass(frozen=True)
class FakeExam:
    """The parts of an exam that grading needs."""

    name: str = 'talker'
    cells: tuple[str, ...] = ('talker',)
    max_points: float = 3


class FakeEngine:
    """Gives a point for the word "right", and raises an error for the words "probe" and "bug"."""

    def __init__(self, *exams):
        self.known, self.threads = exams, set()

    def exams(self, assignment):
        """Return the same exams for every assignment."""
        return self.known

    def run(self, exam, files):
        """Return a result that depends on the words in the files."""
        self.threads.add(threading.current_thread().name)
        text = ''.join(files.values())
        if 'probe' in text and exam.name != 'second':
            raise ProbeFailed(f'exam {exam.name}: the probe broke off.')
        if 'bug' in text:
            raise ZeroDivisionError('oops')
        points = float('right' in text)
        verdict = Verdict.PASSED if points else Verdict.FAILED
        return ExamResult(exam.name, (CheckResult('c', 'C.', verdict, points, 1),))
