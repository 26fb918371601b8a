"""
Lesson 09: multiple-choice questions, each answered by one letter.

The grader reads the answers, never executes them, and starts no program.  This exam, which
learners have, checks only the form of the answers; the hidden exam has the answer key.
"""

from __future__ import annotations

import re

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.submission.cells import chosen_letter, LETTERS, NotALetterError

QUESTIONS = tuple(f'q{number:02}' for number in range(1, 25))

NOT_ANSWERED = Cause(
    'not_answered',
    'The cell was not run, or it still holds None.',
    "Write 'a', 'b', 'c' or 'd' in place of None, and run the cell.",
)
CAUSES = {
    'no_quotes': ('', 'The letter has no quotes.', 'Put the letter in quotes.'),
    'no_literal': (
        '',
        'The answer cannot be read as a letter.',
        'Write one letter in quotes, and nothing that has to be calculated.',
    ),
    'no_letter': ('', 'The answer is not one of the four letters.', 'Write one letter in quotes.'),
    'too_long': (
        '',
        'The answer cannot be read as a letter.',
        'Write one letter in quotes. Keep long notes in a text cell of your own.',
    ),
    'curly_quotes': (
        r'[‘’“”„«»`´].*',
        'Python does not accept curly quotes, which word processors insert, or backticks.',
        "Type the straight quote of the keyboard: '",
    ),
    'assigned': (
        r"""\(?\s*[A-Za-z_]\w{0,40}\s*:?=\s*['"]?[a-d]['"]?\s*\)?""",
        'Your cell assigns the letter to a variable.',
        'Write only the letter, without a variable and =.',
    ),
    'open_quote': (
        r"""['"]{0,2}[a-d]['"]{0,2}""",
        'The quotes before and after the letter do not match.',
        'Write the same quote before and after the letter.',
    ),
    'several_letters': (
        r"""(?![bf]['"])[\[({]?['"]?[a-d](?:['"]?(?:\s|,|/|\+|or|and|oder|y|o)*['"]?[a-d])+['"]?[\])}]?""",
        'There is more than one letter.',
        'Choose one letter; write other thoughts after a #.',
    ),
    'number': (
        r"""['"]?[0-9]['"]?""",
        'The options are letters, not numbers.',
        'Write the letter: a for the first.',
    ),
    'other_alphabet': (
        r"""['"]\s*[^\W\d_a-zA-Z]\s*['"]""",
        'This letter belongs to a different alphabet and only looks like one of the four.',
        'Type it again on a keyboard with Latin letters.',
    ),
}
"""
Pattern, text and advice for each kind of answer that is not a letter.

If a complete answer matches a pattern, the first one counts; otherwise, the reader's reason does.
"""
LONGEST, LONGEST_LINE = 400, 60
"""Maximum length of an answer and of its line when its form is examined [characters]."""


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
    """Return the path of the file that contains the answer to a question."""
    return f'answers/{question}.txt'


def letter_of(run: Run, question: str) -> str:
    """
    Return the chosen letter.

    :raises Failed: if the answer is not one of the letters
    """
    expected = "one of 'a', 'b', 'c', 'd'"
    text = run.files.get(path_of(question), '')
    try:
        letter = chosen_letter(text)
    except NotALetterError as error:
        name = _shape_of(text) or error.reason
        why = Cause(name, *CAUSES[name][1:])
        raise Failed(expected=expected, observed=f'{question}: {error.text}', why=why) from None
    if letter is None:
        raise Failed(expected=expected, observed=f'{question}: no answer yet', why=NOT_ANSWERED)
    return letter


def _shape_of(text: str) -> str:
    """Return the name of the first pattern in :data:`CAUSES` that matches, empty for none."""
    lines = [line.partition('#')[0].strip() for line in text[:LONGEST].splitlines()]
    written = [line for line in lines if line]
    if len(written) != 1 or len(written[0]) > LONGEST_LINE or written[0].lower() in LETTERS:
        return ''
    shapes = ((name, shape) for name, (shape, *_) in CAUSES.items() if shape)
    found = (one for one, shape in shapes if re.fullmatch(shape, written[0], re.IGNORECASE))
    return next(found, '')


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
