"""The outline of a lesson, read from its notebook."""

import json

from collect_sources import laid
import pytest

from autograder.layout import lesson_files
from autograder.submission.outline import read_outline

OBJECTIVES = """\
## What you will be able to do

| Part | Afterwards you can | Minutes |
|---|---|---|
| 1: A | count to 9 | 10 |
| 2: B | count on | 5 |
"""
CHECK = {'grade': True, 'solution': False, 'grade_id': 'check_talker', 'points': 8}
WRITTEN = {'grade': True, 'solution': True, 'grade_id': 'essay', 'points': 5}


@pytest.fixture
def lesson(tmp_path):
    """Return the path of a lesson with two parts, a question and an exercise."""
    cells = [
        ('markdown', '# Topics\n\n```\n# not this\n## nor this\n```', {}),
        ('markdown', OBJECTIVES, {}),
        ('markdown', '## Part 1: A\n\n| Lesson | Minutes |\n|---|---|\n| x | 99 |', {}),
        ('code', "display(quiz('03-a'), quiz('03-b'))", {}),
        ('markdown', '## Part 2: B\n\n### An exercise', {}),
        ('code', "check('talker')", {'nbgrader': CHECK}),
        ('code', 'x', {'nbgrader': WRITTEN}),
    ]
    notebook = {
        'cells': [
            {'cell_type': kind, 'source': source.splitlines(keepends=True), 'metadata': metadata}
            for kind, source, metadata in cells
        ],
        'metadata': {'lesson': {'needs': ['01']}},
    }
    path = tmp_path / '03_topics' / 'topics.ipynb'
    path.parent.mkdir()
    path.write_text(json.dumps(notebook))
    return path


def test_outline_has_title_parts_and_minutes(lesson):
    outline = read_outline(lesson)

    assert (outline.number, outline.title, outline.minutes) == ('03', 'Topics', 15)
    assert [part.heading for part in outline.parts] == [
        'Topics',
        'What you will be able to do',
        'Part 1: A',
        'Part 2: B',
    ]
    assert outline.facts == {'needs': ['01']}


def test_exercises_belong_to_the_part_above_them(lesson):
    """A written answer is not an exercise, because it has no visible check."""
    outline = read_outline(lesson)

    assert outline.parts[2].quizzes == ['03-a', '03-b']
    assert outline.parts[3].checks == {'talker': 8}
    assert outline.points == 8


def test_lessons_are_in_the_order_of_their_numbers(lesson, tmp_path):
    checkpoint = '.ipynb_checkpoints/START_HERE-checkpoint.ipynb'
    laid(tmp_path, dict.fromkeys(('START_HERE.ipynb', checkpoint, '01_a/a.ipynb'), b'{}'))

    assert lesson_files(tmp_path) == [tmp_path / '01_a' / 'a.ipynb', lesson]


@pytest.mark.parametrize('text', ['', '[]', '{"cells": 1}'])
def test_file_that_is_not_a_notebook_is_refused(lesson, text):
    lesson.write_text(text)

    with pytest.raises(ValueError, match=r'Expecting value|not a notebook'):
        read_outline(lesson)
