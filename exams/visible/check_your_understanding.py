"""
Lesson 09: multiple-choice questions, each answered by one letter.

The grader reads the answers, never executes them, and starts no program.  This exam, which
learners have, checks only the form of the answers; the hidden exam has the answer key.
"""

import re

from autograder.exam.exam import Exam, Failed, Run, Scenario
from autograder.exam.words import Causes
from autograder.submission.cells import chosen_letter, LETTERS, NotALetterError

QUESTIONS = tuple(f'q{number:02}' for number in range(1, 25))

WHY = Causes(__file__)
SHAPES = {
    'curly_quotes': r'[‘’“”„«»`´].*',
    'assigned': r"""\(?\s*[A-Za-z_]\w{0,40}\s*:?=\s*['"]?[a-d]['"]?\s*\)?""",
    'open_quote': r"""['"]{0,2}[a-d]['"]{0,2}""",
    'several_letters': (
        r"""(?![bf]['"])[\[({]?['"]?[a-d]"""
        r"""(?:['"]?(?:\s|,|/|\+|or|and|oder|y|o)*['"]?[a-d])+['"]?[\])}]?"""
    ),
    'number': r"""['"]?[0-9]['"]?""",
    'other_alphabet': r"""['"]\s*[^\W\d_a-zA-Z]\s*['"]""",
}
"""
Patterns for complete answers that are not a letter, by cause.

If none matches, the cause is the reason of :class:`autograder.submission.cells.NotALetterError`.
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
    """Return the chosen letter; fail if the answer is not one of the letters."""
    expected = "one of 'a', 'b', 'c', 'd'"
    text = run.files.get(path_of(question), '')
    try:
        letter = chosen_letter(text)
    except NotALetterError as error:
        why = WHY[_shape_of(text) or error.reason]
        raise Failed(expected=expected, observed=f'{question}: {error.text}', why=why) from None
    if letter is None:
        raise Failed(
            expected=expected, observed=f'{question}: no answer yet', why=WHY['not_answered']
        )
    return letter


def _shape_of(text: str) -> str:
    """Return the name of the first pattern in :data:`SHAPES` that matches, empty for none."""
    lines = [line.partition('#')[0].strip() for line in text[:LONGEST].splitlines()]
    written = [line for line in lines if line]
    if len(written) != 1 or len(written[0]) > LONGEST_LINE or written[0].lower() in LETTERS:
        return ''
    found = (n for n, one in SHAPES.items() if re.fullmatch(one, written[0], re.IGNORECASE))
    return next(found, '')


exam = build()


@exam.check(points=1, static=True)
def every_question_is_answered(run: Run) -> None:
    """
    Every question has a letter.

    This check tests only the form, and its point does not count: any letter passes here.  Each
    question is graded later, with one point.
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
