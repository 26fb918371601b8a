"""Cells become files, and the release defines the file of each answer."""

from dataclasses import dataclass

import pytest

from autograder.results import CheckResult, ExamResult, Problem, SubmissionResult, Verdict
from autograder.submission.notebook import marks_of, StudentCell
from autograder.submission.submission import answer_files, extract, Opened, rebuild, with_reasons


@dataclass(frozen=True)
class FakeExam:
    """The parts of an exam that extraction needs."""

    name: str
    cells: tuple[str, ...]


EXAMS = (FakeExam('message', ('msg', 'xml')), FakeExam('talker', ('talker',)))


def solution(grade_id, source):
    marks = {'grade_id': grade_id, 'solution': True}
    return {'cell_type': 'code', 'metadata': {'nbgrader': marks}, 'source': source}


RELEASE = {
    'cells': [
        solution('msg', '%%rosmsg Num\n# YOUR CODE HERE'),
        solution('xml', '%%rospkg package.xml\n<!-- YOUR CODE HERE -->'),
        solution('talker', '%%node talker\n# YOUR CODE HERE\nraise NotImplementedError()'),
    ]
}


def files_of(**answers):
    stubs = {marks_of(cell)['grade_id']: cell['source'] for cell in RELEASE['cells']}
    sources = {**stubs, **answers}.items()
    student = [StudentCell(name, 'code', text) for name, text in sources if text is not None]
    notebook, problems = rebuild(RELEASE, student, 'x')
    return extract(Opened(notebook, problems), EXAMS, RELEASE, 'x')


def test_the_release_says_which_file_each_answer_is():
    """Paths are relative to the package."""
    paths = {name: file.path for name, file in answer_files(RELEASE).items()}

    assert paths == {'msg': 'msg/Num.msg', 'xml': 'package.xml', 'talker': 'talker.py'}


def test_answers_become_files_without_their_magic_line():
    found = files_of(msg='%%rosmsg Num\nint64 num', talker='%%node talker\nimport rclpy')

    assert found['message'].files['msg/Num.msg'] == 'int64 num\n'
    assert found['talker'].files == {'talker.py': 'import rclpy\n'}
    assert found['talker'].problems == ()


def test_an_untouched_stub_is_a_file_too():
    assert 'NotImplementedError' in files_of()['talker'].files['talker.py']


def test_a_missing_cell_is_no_file_although_the_stub_is_in_the_notebook():
    found = files_of(talker=None)

    assert found['talker'].files == {}
    assert list(found['message'].files) == ['msg/Num.msg', 'package.xml']


@pytest.mark.parametrize(
    ('source', 'got'),
    [
        ('%%node taler\npass', "'%%node taler'"),
        ('%%rosmsg Talker\nint64 x', "'%%rosmsg Talker'"),
        ('%%node\npass', "'%%node'"),
        ('%%node ../../x\npass', "'%%node ../../x'"),
        ('import rclpy\n', "'import rclpy'"),
        ('', 'an empty cell'),
        ('  \n\n', 'an empty cell'),
        ('%%node a' + ' \t' * 16_000 + '!', repr('%%node a' + ' \t' * 26)),
    ],
)
def test_a_wrong_first_line_is_reported_with_the_right_one(source, got):
    """The file counts as missing, because the notebook did not save it either."""
    found = files_of(talker=source)['talker']

    assert found.files == {}
    (problem,) = found.problems
    assert problem.got == got
    assert problem.expected == 'the first line %%node talker'
    assert problem.cells == ('talker',)


def test_blank_lines_above_the_magic_line_are_fine():
    assert files_of(talker='\n\n%%node talker\nx = 1')['talker'].files == {'talker.py': 'x = 1\n'}


def test_an_answer_that_is_not_there_points_to_the_note_that_says_why():
    def result(exam):
        missing = {'cause': 'The cell is missing.', 'cause_id': 'missing_file'}
        check = CheckResult('runs', 'It runs.', Verdict.FAILED, 0, 1, **missing)
        return ExamResult(exam, (check,))

    cut = Problem('x.ipynb', 'a whole file', 'one that ends', 'hand in again', ('talker',))
    before = SubmissionResult('ann', 'a', (result('message'), result('talker')), (cut,))
    message, talker = with_reasons(before, EXAMS).exams

    assert message.checks[0].cause == 'The cell is missing.'
    assert 'the note says why' in talker.checks[0].cause
    assert talker.checks[0].try_this == 'Hand in again.'
