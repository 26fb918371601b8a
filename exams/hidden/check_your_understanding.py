"""
Hidden exam of lesson 09: one point per question, and a reason for each wrong option.

The answer key is in a YAML file next to this module, which students never receive.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from autograder.errors import ExamInvalid
from autograder.exam.exam import Cause, Failed, Run
from autograder.judging.claims import claim
from autograder.submission.cells import LETTERS
from exams.visible.check_your_understanding import build, letter_of, QUESTIONS

KEY = Path(__file__).with_suffix('.yaml')
RUN_IT = 'Run the cells of that section again, and predict the result of each cell first.'


def key() -> Mapping[str, Mapping[str, Any]]:
    """
    Return the answer key, by question.

    :raises ExamInvalid: if a question or the explanation of a wrong option is missing
    """
    found = yaml.safe_load(KEY.read_text(encoding='utf-8'))
    if tuple(found) != QUESTIONS:
        raise ExamInvalid(f'{KEY.name}: expected {QUESTIONS[0]} to {QUESTIONS[-1]}, in order.')
    for question, entry in found.items():
        if {entry['right'], *entry['why']} != set(LETTERS) or entry['right'] in entry['why']:
            raise ExamInvalid(
                f'{KEY.name}, {question}: expected one right letter, and why the rest are wrong.'
            )
    return dict(found)


def judge(question: str, entry: Mapping[str, Any]) -> Callable[[Run], None]:
    """Return the function that judges the answer to one question."""

    def is_right(run: Run) -> None:
        letter = letter_of(run, question)
        if letter == entry['right']:
            return
        raise Failed(
            expected='the option that is true',
            observed=f'the letter {letter!r}',
            why=Cause(f'{question}_{letter}', entry['why'][letter], RUN_IT),
        )

    return is_right


exam = build()
for _question, _entry in key().items():
    exam.check(points=1, read=_entry['read'], static=True)(
        claim(
            _question,
            f'Question {int(_question[1:])}, {_entry["about"]}.',
            judge(_question, _entry),
        )
    )
