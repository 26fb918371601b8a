"""Collect the worked answers of a course from its solutions, for the students' copy."""

from __future__ import annotations

import re

from autograder.exam.catalog import for_assignment
from autograder.explaining.worked_answers import encoded, FOLDER
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import marks_of, read_release

MARK = re.compile(r'^ *### (?:BEGIN|END) SOLUTION *\n?', re.MULTILINE)


def answer_files(layout: Layout) -> dict[str, bytes]:
    """Return one file per lesson with exercises: its content by its name in the students' copy."""
    found = {}
    for path in lesson_files(layout.solutions):
        lesson = path.parent.name
        cells = {
            marks['grade_id']: cell['source']
            for cell in read_release(path)['cells']
            if cell['cell_type'] == 'code' and (marks := marks_of(cell)).get('solution')
        }
        answers = {
            exam.name: '\n\n\n'.join(MARK.sub('', cells[one]).strip() for one in exam.cells)
            for exam in for_assignment(lesson)
        }
        if answers:
            found[f'{FOLDER}/{lesson}.txt'] = encoded(answers)
    return found
