"""A lesson in which nothing is graded goes through all stages like the others."""

import json
from pathlib import Path
import shutil

from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
import pytest

from autograder.classroom.pages import write_all_reports
from autograder.gradebook import converters
from autograder.gradebook.record import enter_assignment, record
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.submission.inbox import discover

pytestmark = pytest.mark.nbgrader

ROOT = Path(__file__).resolve().parents[2]
ASSIGNMENT = '00_tour'


class NoExams:
    """An engine for a course without exams."""

    def exams(self, assignment):
        return ()

    def run(self, exam, files):
        raise AssertionError('nothing is to be run')


def test_lesson_without_exams_is_released_graded_and_reported(tmp_path):
    """A student who hands in the lesson gets 0 of 0 points and a page."""
    layout = Layout(tmp_path)
    for name in ('course.toml', 'nbgrader_config.py'):
        shutil.copy(ROOT / name, tmp_path)
    source = layout.solutions / ASSIGNMENT / 'tour.ipynb'
    source.parent.mkdir(parents=True)
    notebook = new_notebook(cells=[new_markdown_cell('# Tour'), new_code_cell('1 + 1')])
    source.write_text(json.dumps(notebook), encoding='utf-8')
    converters.generate(layout, ASSIGNMENT, layout.notebooks, database=False)
    handed_in = layout.submitted / 'ann' / ASSIGNMENT
    shutil.copytree(layout.release(ASSIGNMENT).parent, handed_in)

    lesson = load_lesson(layout, ASSIGNMENT, NoExams())
    submissions = discover(layout.submitted, ASSIGNMENT, lesson.notebook, layout.assignments())
    enter_assignment(layout, ASSIGNMENT)
    (graded,) = grade_class(submissions, lesson, NoExams(), jobs=1)
    record(layout, lesson, [graded])
    page = write_all_reports(layout, ASSIGNMENT, [graded.result], 'one submission')

    assert (graded.result.points, graded.result.max_points, graded.result.fault) == (0, 0, '')
    assert 'ann' in page.read_text(encoding='utf-8')
