"""Results of checks and quizzes are stored, shown and deleted."""

from concurrent.futures import ThreadPoolExecutor
import json

from collect_sources import laid
import pytest

from autograder.layout import CHOSEN
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.submission.outline import Outline, Part
from roslab import checking, quiz
from roslab.checking import CheckReport
from roslab.errors import RoslabError
from roslab.progress import as_text, next_part, progress, read_results, remember

NONE = {'checks': {}, 'quizzes': {}, 'tries': {}}


@pytest.fixture
def file(tmp_path, monkeypatch):
    """Return the path of the results file of an empty course, and work in its lesson."""
    root = tmp_path / 'course'
    (root / 'notebooks' / '01_a').mkdir(parents=True)
    (root / 'course.toml').write_text("name = 'small'\nwork = '_work'\n")
    monkeypatch.chdir(root / 'notebooks' / '01_a')
    monkeypatch.delenv(CHOSEN, raising=False)
    return root / '_work' / 'progress.json'


@pytest.fixture
def lessons(tmp_path):
    first = Part('Part 1: One', quizzes=['01-a', '01-b'])
    second = Part('Part 2: Two', {'talker': 8, 'courier': 10})
    return [
        Outline(tmp_path / '01_a' / 'a.ipynb', 'First', (first, second), 65, {}),
        Outline(tmp_path / '02_b' / 'b.ipynb', 'Second <b>', (Part('Second <b>'),), 0, {}),
    ]


class TestRemember:
    def test_last_result_of_each_exercise_is_kept(self, file):
        remember('checks', 'talker', 8)
        remember('quizzes', '01-a', False)
        remember('checks', 'talker', 2.5)

        expected = {'checks': {'talker': 2.5}, 'quizzes': {'01-a': False}}
        assert read_results(file) == NONE | expected
        assert 'progress(forget=True)' in json.loads(file.read_text())['about']

    def test_notebooks_that_finish_together_lose_nothing(self, file):
        with ThreadPoolExecutor(8) as pool:
            list(pool.map(lambda n: remember('checks', f'exam_{n}', n), range(32)))

        assert len(read_results(file)['checks']) == 32

    def test_notebook_outside_the_course_stores_no_progress(self, file, tmp_path, monkeypatch):
        """Tests execute copies of lessons in other folders."""
        monkeypatch.setenv(CHOSEN, str(file.parent.parent))
        monkeypatch.chdir(tmp_path)
        remember('checks', 'talker', 8)

        assert not file.exists()

    def test_check_remembers_its_points(self, file, monkeypatch):
        result = ExamResult('talker', (CheckResult('c', 'C.', Verdict.PASSED, 3, 3),))
        reports = iter([CheckReport('talker', result), CheckReport('talker')])
        monkeypatch.setattr(checking, '_run', lambda *_: next(reports))
        checking.check('talker')
        checking.check('talker')

        assert read_results(file)['checks'] == {'talker': 3}

    def test_quiz_remembers_whether_the_last_answer_was_right(self, file):
        question = quiz('07-threshold')
        rights = [option['right'] for option in question.question['options']]
        question.chosen = rights.index(False)
        assert read_results(file)['quizzes'] == {'07-threshold': False}
        question.chosen = rights.index(True)
        assert read_results(file)['quizzes'] == {'07-threshold': True}


BROKEN = [
    '',
    '{',
    '[]',
    '{"checks": {}}',
    '{"checks": {"a": "x"}, "quizzes": {}}',
    '{"checks": {"a": Infinity}, "quizzes": {}}',
    '{"checks": {"a": NaN}, "quizzes": {}}',
    '\x00',
    '[' * 9999,
]


class TestBrokenFile:
    @pytest.mark.parametrize('text', BROKEN)
    def test_result_is_not_remembered_and_the_file_stays(self, file, capsys, text):
        file.parent.mkdir()
        file.write_text(text)
        remember('checks', 'talker', 8)

        said = f'progress() will not show this result. {file}: '
        assert capsys.readouterr().out.startswith(said)
        assert file.read_text() == text

    def test_progress_says_how_to_delete_it(self, file):
        file.parent.mkdir()
        file.write_text('my own notes')

        with pytest.raises(RoslabError, match=r'Try: progress\(forget=True\)'):
            progress()
        assert file.read_text() == 'my own notes'

    def test_folder_that_cannot_be_written_is_one_line(self, file, capsys):
        """All students on a computer may share one read-only course."""
        file.parent.write_text('a file in place of the folder')
        remember('checks', 'talker', 8)

        assert capsys.readouterr().out.count('\n') == 1


class TestProgress:
    def test_first_unfinished_part_comes_next(self, lessons):
        answered = {'01-a': False, '01-b': True}

        assert next_part(lessons, NONE)[1].heading == 'Part 1: One'
        for checks, heading in (({}, 'Part 2: Two'), ({'talker': 8, 'courier': 9}, 'Part 2: Two')):
            found = next_part(lessons, {'checks': checks, 'quizzes': answered})
            assert found[1].heading == heading
        done = {'checks': {'talker': 8, 'courier': 10}, 'quizzes': answered}
        assert next_part(lessons, done) is None
        assert as_text(lessons, done).startswith('18 of 18 points; every exercise')

    def test_text_has_points_and_right_answers(self, lessons):
        results = {
            'checks': {'talker': 99, 'courier': 2.5, 'of_an_older_course': 7},
            'quizzes': {'01-a': False, '01-b': True},
        }

        assert as_text(lessons, results).splitlines() == [
            '10.5 of 18 points; next: lesson 01, Part 2',
            '',
            'lesson         minutes      points    quiz',
            '01 First            65  10.5 of 18  1 of 2',
            '02 Second <b>',
        ]

    def test_unreadable_notebook_costs_only_its_own_row(self, file, capsys):
        lessons = {'01_a/a.ipynb': b'{"cells": []}', '02_b/b.ipynb': b'{'}
        laid(file.parent.parent / 'notebooks', lessons)
        progress()
        rows = capsys.readouterr().out.splitlines()[3:]

        assert rows == ['01 a', '02 b.ipynb cannot be read']

    def test_forget_deletes_the_results(self, file, capsys):
        remember('checks', 'talker', 8)
        progress(forget=True)
        progress(forget=True)

        assert not file.exists()
        assert 'Your notebooks and saved files are unchanged.' in capsys.readouterr().out
