"""A worked answer opens after full points or three tries, if the instructor has packed it."""

import json
import zipfile

import nbformat
import pytest

from autograder.authoring.student_bundle import answer_files, pack, TOP
from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.explaining.worked_answers import encoded, FOLDER, read_answers
from autograder.layout import CHOSEN, Layout, lesson_files
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.submission.notebook import marks_of
from roslab import checking
from roslab.checking import CheckReport
from roslab.errors import NotHereError, RoslabError
from roslab.progress import answer, offer, progress, remember, TRIES

COURSE = Layout.here()
WORDS = 'class Talker(Node): ...  # <one> of many'
MOST = catalog.load('talker', hidden=False).max_points


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """Return a students' copy with one worked answer, and make it the current folder."""
    root = tmp_path / 'copy'
    (root / FOLDER).mkdir(parents=True)
    (root / 'course.toml').write_text("work = '_work'\n")
    (root / 'exams').symlink_to(COURSE.exams)
    (root / FOLDER / '03_topics.txt').write_bytes(encoded({'talker': WORDS}))
    monkeypatch.chdir(root)
    monkeypatch.delenv(CHOSEN, raising=False)
    return root


def check(monkeypatch, points, **facts):
    """Check an answer that gets these points, and return the report."""
    verdict = Verdict.PASSED if points == MOST else Verdict.FAILED
    result = ExamResult('talker', (CheckResult('c', 'C.', verdict, points, MOST),))
    monkeypatch.setattr(checking, '_run', lambda *_: CheckReport('talker', result=result, **facts))
    return checking.check('talker')


class TestOpening:
    def test_third_try_opens_it(self, copy, monkeypatch, capsys):
        said = [str(check(monkeypatch, 0)).splitlines()[-1] for _ in range(TRIES)]
        answer('talker')

        assert '2 more tries' in said[0]
        assert 'one more try' in said[1]
        assert said[2].startswith('Show me a worked answer: ')
        assert capsys.readouterr().out.endswith(f'{WORDS}\n')

    def test_full_points_open_it_at_once(self, copy, monkeypatch):
        page = check(monkeypatch, MOST)._repr_html_()

        assert '<details><summary>Show me a worked answer</summary>' in page
        assert '&lt;one&gt; of many' in page

    def test_closed_answer_is_nowhere(self, copy, monkeypatch):
        report = check(monkeypatch, 0)
        with pytest.raises(RoslabError, match='2 more tries') as refused:
            answer('talker')

        assert WORDS not in f'{report}{report._repr_html_()}{refused.value}'
        assert 'details' not in report._repr_html_()

    def test_check_of_a_stub_is_no_try(self, copy, monkeypatch):
        for _ in range(TRIES):
            report = check(monkeypatch, 0, unfinished=('talker.py',))

        assert f'{TRIES} more tries' in str(report)

    def test_forgetting_progress_closes_it_again(self, copy, monkeypatch):
        check(monkeypatch, MOST)
        progress(forget=True)

        assert 'gives full points' in offer('talker')[0]

    def test_results_from_before_tries_were_counted_are_kept(self, copy):
        file = copy / '_work' / 'progress.json'
        file.parent.mkdir()
        file.write_text(json.dumps({'checks': {'talker': 1}, 'quizzes': {}}))
        remember('checks', 'talker', 2, tries=1)

        assert json.loads(file.read_text())['tries'] == {'talker': 1}


class TestCopies:
    def test_copy_without_answers_does_not_mention_them(self, copy, monkeypatch):
        (copy / FOLDER / '03_topics.txt').unlink()
        report = check(monkeypatch, MOST)

        assert 'worked answer' not in f'{report}{report._repr_html_()}'
        with pytest.raises(NotHereError, match='no worked answer'):
            answer('talker')

    def test_damaged_file_is_named_by_answer_and_does_not_stop_a_check(self, copy, monkeypatch):
        (copy / FOLDER / '03_topics.txt').write_bytes(b'# x\nnonsense')

        assert check(monkeypatch, MOST)
        with pytest.raises(GraderError, match='03_topics'):
            answer('talker')

    def test_bundle_holds_answers_on_request_only(self, tmp_path):
        """Only the first line of the file is readable, so no answer is read by accident."""
        for wanted in (False, True):
            pack(COURSE, tmp_path / 'copy.zip', answers=wanted)
            with zipfile.ZipFile(tmp_path / 'copy.zip') as archive:
                names = [one for one in archive.namelist() if f'/{FOLDER}/' in one]
                assert bool(names) == wanted
        with zipfile.ZipFile(tmp_path / 'copy.zip') as archive:
            text = archive.read(f'{TOP}/{FOLDER}/03_topics.txt').decode()

        assert 'not secret' in text.splitlines()[0]
        assert 'Node' not in text

    def test_every_graded_exercise_has_one(self, tmp_path):
        found = {}
        for data in answer_files(COURSE).values():
            (tmp_path / 'one').write_bytes(data)
            found |= read_answers(tmp_path / 'one')
        checked = {
            marks['grade_id'].removeprefix('check_')
            for path in lesson_files(COURSE.notebooks)
            for cell in nbformat.read(path, as_version=4).cells
            if cell.cell_type == 'code' and (marks := marks_of(cell)).get('grade')
        }

        # check_your_understanding has no worked answer: wrong letters pass its visible check.
        assert found.keys() == checked - {'check_your_understanding'}
        assert not any('SOLUTION' in text or 'YOUR CODE HERE' in text for text in found.values())
        assert "create_publisher(String, 'chatter'" in found['talker']
