"""
Lesson 09: multiple-choice questions, answered by one letter each.

Answers are read, never executed, and no program is started.  What learners have here looks at the
form of the answers only; which letter is right lies with the hidden exam.
"""

from __future__ import annotations

from autograder.cells import chosen_letter, NotALetterError
from autograder.exam import Cause, Exam, Failed, Run, Scenario

QUESTIONS = tuple(f'q{number:02}' for number in range(1, 25))

NOT_ANSWERED = Cause(
    'not_answered',
    'The cell was not run, or it still holds None.',
    "Write 'a', 'b', 'c' or 'd' in place of None, and run the cell.",
)
_ADVICE = {
    'no_quotes': 'Put the letter in quotes.',
    'no_literal': 'Write one letter in quotes, and nothing that has to be calculated.',
    'no_letter': 'Write one letter in quotes.',
    'too_long': 'Write one letter in quotes. Keep long notes in a text cell of your own.',
}


def build() -> Exam:
    """Return the exam without its checks."""
    return Exam(
        'check_your_understanding',
        title='Multiple-choice questions on the whole course',
        assignment='09_check_your_understanding',
        part=1,
        cells=QUESTIONS,
        requires=(),
        scenario=Scenario(program=''),
        read='How to answer',
    )


def path_of(question: str) -> str:
    """Return where the answer to a question is saved."""
    return f'answers/{question}.txt'


def letter_of(run: Run, question: str) -> str:
    """
    Return the letter that was chosen.

    :raises Failed: if there is none
    """
    expected = "one of 'a', 'b', 'c', 'd'"
    try:
        letter = chosen_letter(run.files.get(path_of(question), ''))
    except NotALetterError as error:
        why = Cause(error.reason, 'The answer cannot be read as a letter.', _ADVICE[error.reason])
        raise Failed(expected=expected, observed=f'{question}: {error.text}', why=why) from None
    if letter is None:
        raise Failed(expected=expected, observed=f'{question}: no answer yet', why=NOT_ANSWERED)
    return letter


exam = build()


@exam.check(points=1, static=True)
def every_question_is_answered(run: Run) -> None:
    """
    Every question has a letter.

    This point is for the form alone and does not count: each question is graded later, with one
    point, and any letter passes here.
    """
    found: list[Failed] = []
    for question in QUESTIONS:
        try:
            letter_of(run, question)
        except Failed as failure:
            found.append(failure)
    if not found:
        return
    shown = [failure.observed for failure in found[:4]]
    more = [f'and {len(found) - 4} more'] if len(found) > 4 else []
    raise Failed(
        expected=f"{len(QUESTIONS)} questions with one of 'a', 'b', 'c', 'd'",
        observed='; '.join(shown + more),
        why=found[0].why,
    )
