"""Multiple-choice questions: the letter of an ``%%answer`` cell, and the exam that reads it."""

from itertools import pairwise
from pathlib import Path
import re

import pytest

from autograder.authoring.student_bundle import bundled_files
from autograder.exam import catalog
from autograder.exam.exam import Run
from autograder.judging.judge import judge, worth_running
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import Verdict
from autograder.submission.cells import ANSWER_MAX, chosen_letter, NotALetterError, parse_cell
from autograder.submission.notebook import read_release
from exams.hidden.check_your_understanding import key
from exams.visible.check_your_understanding import path_of, QUESTIONS
from roslab.errors import AnswerRefusedError
from roslab.magics import run_cell

EXAM = 'check_your_understanding'
STUB = "None  # YOUR CODE HERE: 'a', 'b', 'c' or 'd' in place of None\n"


@pytest.mark.parametrize(
    'body',
    [
        "'b'\n",
        '"b"',
        "'B'",
        "' b '",
        "  'b'  ",
        "# 3 of 4\n\n'b'  # sure\n",
        "'''b'''",
        "(\n'b'\n)",
    ],
)
def test_letter_is_read_however_it_is_written(body):
    assert chosen_letter(body) == 'b'


@pytest.mark.parametrize('body', ['', '\n', STUB, 'None', "# 'b'\n"])
def test_cell_without_an_answer_has_no_letter(body):
    assert chosen_letter(body) is None


@pytest.mark.parametrize(
    ('body', 'reason'),
    [
        ('b', 'no_quotes'),
        ('B  # sure', 'no_quotes'),
        ("'e'", 'no_letter'),
        ("''", 'no_letter'),
        ("'ab'", 'no_letter'),
        ("['b']", 'no_letter'),
        ("b'b'", 'no_letter'),
        ('2', 'no_letter'),
        ('True', 'no_letter'),
        ("'\\x62'", 'no_letter'),
        ("'b'\n'c'", 'no_literal'),
        ("f'b'", 'no_literal'),
        ("'b", 'no_literal'),
        ('\x00', 'no_literal'),
        ('\ud800', 'no_literal'),
        ('(' * 1500, 'no_literal'),
        ('-' * 1500 + "'b'", 'no_literal'),
        ('[' * 900 + ']' * 900, 'no_literal'),
        ("'b'" + ' ' * ANSWER_MAX, 'too_long'),
    ],
)
def test_anything_else_is_refused_with_a_printable_reason(body, reason):
    with pytest.raises(NotALetterError) as caught:
        chosen_letter(body)

    assert caught.value.reason == reason
    assert caught.value.text.isprintable()
    assert len(str(caught.value)) < 100


def test_code_in_an_answer_is_never_executed(tmp_path):
    trace = tmp_path / 'trace'
    for body in (f"open('{trace}', 'w') and 'b'", f"__import__('os').system('touch {trace}')"):
        with pytest.raises(NotALetterError):
            chosen_letter(body)
    assert not trace.exists()


class TestMagic:
    @pytest.fixture(autouse=True)
    def work_in_an_empty_folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)

    def saved(self):
        return [path.read_text() for path in Path().rglob('answers/q07.txt')]

    def test_answer_is_saved_and_said(self, capsys):
        run_cell('answer', 'q07', '"B"  # sure\n', {})

        assert capsys.readouterr() == ('Saved your answer to q07: b\n', '')
        assert self.saved() == ['"B"  # sure\n']

    def test_stub_is_not_written_yet(self):
        with pytest.raises(NotImplementedError, match='%%answer q07 is not written yet') as caught:
            run_cell('answer', 'q07', STUB, {})

        assert caught.value._render_traceback_() == [f'NotImplementedError: {caught.value}']
        assert self.saved() == [STUB]

    @pytest.mark.parametrize(
        ('body', 'said'),
        [
            ('b\n', "expected 'a', 'b', 'c' or 'd', got b. Put the letter in quotes."),
            ("'e'\n", "expected 'a', 'b', 'c' or 'd', got 'e'. Write one letter."),
        ],
    )
    def test_no_letter_is_refused_and_replaces_the_older_answer(self, body, said):
        """The file gets the cell's content, so that the earlier letter is not checked."""
        run_cell('answer', 'q07', "'a'\n", {})
        with pytest.raises(AnswerRefusedError, match=re.escape(said)):
            run_cell('answer', 'q07', body, {})

        assert self.saved() == [body]


def answers(**letters):
    """Return files with the given letters, and with 'a' for every other question."""
    return {path_of(name): f"'{letters.get(name, 'a')}'\n" for name in QUESTIONS}


def results(files, hidden):
    """Return the results of the exam by check, without running a program."""
    exam = catalog.load(EXAM, hidden=hidden)
    assert not worth_running(exam, files)
    return {one.check: one for one in judge(exam, Run(files, Recording({}, ()), exam.facts))}


RIGHT = {name: entry['right'] for name, entry in key().items()}


def test_visible_check_looks_at_the_form_only():
    right, wrong = (results(answers(**letters), hidden=False) for letters in (RIGHT, {}))

    assert right == wrong
    assert all(one.verdict is Verdict.PASSED for one in right.values())


def test_visible_check_names_the_questions_without_a_letter():
    (one,) = results({path_of('q01'): "'a'\n", path_of('q02'): 'b\n'}, hidden=False).values()

    assert one.verdict is Verdict.FAILED
    assert one.observed == (
        'q02: b; q03: no answer yet; q04: no answer yet; q05: no answer yet; and 19 more'
    )


def test_each_question_counts_for_itself():
    files = answers(**{**RIGHT, 'q22': 'c'})
    del files[path_of('q03')]
    found = results(files, hidden=True)

    assert {name for name, one in found.items() if one.verdict is Verdict.FAILED} == {'q03', 'q22'}
    assert (found['q22'].cause_id, found['q03'].cause_id) == ('q22_c', 'not_answered')


@pytest.mark.parametrize('letter', 'abcd')
def test_wrong_answer_is_explained_without_the_right_letter(letter):
    found = results(answers(**dict.fromkeys(QUESTIONS, letter)), hidden=True)
    for name, one in found.items():
        assert (one.verdict is Verdict.PASSED) == (RIGHT[name] == letter)
        shown = f'{one.expected} {one.cause} {one.try_this}'

        assert one.verdict is Verdict.PASSED or len(one.cause) > 40, name
        assert not re.search(r"'[a-d]'|\b[b-d]\b", shown), shown


def test_blind_guessing_does_not_pay():
    assert sorted(list(RIGHT.values()).count(letter) for letter in 'abcd') == [6, 6, 6, 6]


def test_key_stays_with_the_instructor():
    layout = Layout.here()
    names = bundled_files(layout)
    texts = [path.read_text(encoding='utf-8', errors='replace') for path in names.values()]
    sentences = [why for entry in key().values() for why in entry['why'].values()]

    assert f'exams/visible/{EXAM}.py' in names
    assert not [name for name in names if 'hidden' in name]
    assert not [why for why in sentences for text in texts if why in text]


def test_release_asks_every_question_with_four_options():
    cells = read_release(Layout.here().release('09_check_your_understanding'))['cells']
    asked = {}
    for text, cell in pairwise(cells):
        file = parse_cell(cell['source']) if cell['cell_type'] == 'code' else None
        if file is not None:
            assert file.body == STUB
            asked[file.name] = re.findall(r'^\* \*\*([a-d])\*\* \S', text['source'], re.MULTILINE)

    assert asked == {name: list('abcd') for name in QUESTIONS}
