"""Four ways to show the feedback on one submission contain the same words."""

import json
from pathlib import Path

from bs4 import BeautifulSoup
from conftest import ASSIGNMENT, copied
import nbformat
import pytest
from test_nbgrader_round_trip import nbgrader
from test_sample_class import EXAMINED

from autograder import __main__ as command
from autograder.authoring import sample_class
from autograder.authoring.exam_mistakes import lesson_headings, no_section, read_mistakes
from autograder.classroom.pages import page_name, write_all_reports
from autograder.commands import OK
from autograder.exam import catalog
from autograder.explaining.feedback import causes_once, check_lines, feedback_items
from autograder.gradebook.record import record
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.sandboxes.choose import strongest
from autograder.submission.inbox import Submission
from autograder.submission.notebook import answer_cells
from roslab import checking
from roslab.package_files import LearnerPackage

pytestmark = [pytest.mark.pipeline, pytest.mark.slow, pytest.mark.ros, pytest.mark.nbgrader]

HERE = Layout.here()
SAMPLE = 'fail__topic_typo'
EXAM = 'temperature_publisher'
NOTEBOOK = 'temperature_monitor.ipynb'


def read(page):
    """Return the parts of a page."""
    return BeautifulSoup(page, 'html.parser')


def links_of(page):
    return [one['href'] for one in read(page)(href=True)]


def facts_of(page):
    """Return the name and the text of every fact that a page shows about its checks."""
    return [(name.text, text.text) for name, text in zip(read(page)('dt'), read(page)('dd'))]


@pytest.fixture(scope='module')
def course(released, tmp_path_factory):
    """Return a separate course for the one submission."""
    return copied(released, tmp_path_factory.mktemp('words'))


@pytest.fixture(scope='module')
def result(course):
    """Return the sample's results from the visible exams, after all reports are written."""
    folder = HERE.sample_class / ASSIGNMENT / SAMPLE
    data = sample_class.compose(HERE, ASSIGNMENT, folder)
    engine = Engine(strongest(), HERE.recordings, hidden=False)
    lesson = load_lesson(course, ASSIGNMENT, engine)
    done = grade_class([Submission(SAMPLE, folder, data)], lesson, engine, jobs=2)
    record(course, lesson, done)
    nbgrader(course, 'generate_feedback', ASSIGNMENT)
    write_all_reports(course, ASSIGNMENT, [done[0].result])
    return done[0].result


@pytest.fixture(scope='module')
def said(result):
    """Return all facts that feedback on the exam must contain, in order."""
    (exam,) = [one for one in result.exams if one.exam == EXAM]
    words = [fact for check in causes_once(exam) for fact in feedback_items(check)]
    assert {name for name, _ in words} == {
        *('expected', 'observed', 'likely cause', 'try', 'read'),
        'waits for',
    }
    return words


def lines_of(result):
    """Return the lines about the exam's checks, which are identical in all plain texts."""
    (exam,) = [one for one in result.exams if one.exam == EXAM]
    return [line for check in causes_once(exam) for line in check_lines(check)]


def test_nbgraders_feedback_says_them(result, said, course):
    """The course's own page has a picture, and links to the lesson in the same page."""
    (path,) = (course.work / 'feedback' / SAMPLE).rglob('*.html')
    page = path.read_text(encoding='utf-8')

    assert [fact for fact in facts_of(page) if fact in said] == said
    assert len(read(page)('svg')) == 1
    assert '#Part-2:-The-publisher' in links_of(page)
    assert 'id="Part-2:-The-publisher"' in page
    assert not [one for one in links_of(page) if not one.startswith('#') and 'http' not in one]
    assert '<script' not in page


def test_formgrader_says_them(result, said, course):
    """Formgrader shows the outputs of check cells as HTML, or as text without a browser."""
    path = course.work / 'autograded' / SAMPLE / ASSIGNMENT / NOTEBOOK
    notebook = nbformat.read(path, as_version=4)
    (cell,) = [
        cell
        for cell in notebook.cells
        if cell.metadata.get('nbgrader', {}).get('grade_id') == f'check_{EXAM}'
    ]
    data = cell.outputs[0].data

    assert facts_of(data['text/html']) == said
    assert [line for line in data['text/plain'].splitlines() if line][1:] == lines_of(result)


def test_the_report_of_the_class_says_them(result, said, course):
    path = course.reports / ASSIGNMENT / page_name(SAMPLE)
    page = path.read_text(encoding='utf-8')

    assert [fact for fact in facts_of(page) if fact in said] == said
    assert '<svg' in page


def test_the_terminal_says_them(result, said, tmp_path, capsys):
    notebook = tmp_path / NOTEBOOK
    folder = HERE.sample_class / ASSIGNMENT / SAMPLE
    notebook.write_bytes(sample_class.compose(HERE, ASSIGNMENT, folder))

    assert command.main(['run', '--exam', EXAM, '--visible', str(notebook)]) == OK

    printed = [line for line in capsys.readouterr().out.splitlines() if line]
    assert printed[1:-1] == lines_of(result)


def test_the_visible_checks_of_a_notebook_say_them(result, said, tmp_path):
    """The child process of ``check(...)`` returns the text and the HTML that the cell shows."""
    package = LearnerPackage('temp_monitor_pkg', tmp_path)
    nodes = package.folder / 'temp_monitor_pkg'
    nodes.mkdir(parents=True)
    data = sample_class.compose(HERE, ASSIGNMENT, HERE.sample_class / ASSIGNMENT / SAMPLE)
    cell = answer_cells(json.loads(data))['temperature_publisher']
    (nodes / 'temp_publisher.py').write_text(cell['source'].partition('\n')[2])

    report = checking._run(EXAM, package)

    lines = str(report).splitlines()
    assert lines[1].startswith('  Judged: temp_publisher.py, saved ')
    assert lines[2:] == lines_of(result)
    assert facts_of(report._repr_html_()) == said
    assert f'{NOTEBOOK}#Part-2:-The-publisher' in links_of(report._repr_html_())
    assert len(read(report._repr_html_())('svg')) == 1


@pytest.mark.parametrize('hidden', [True, False], ids=['graded', 'visible'])
@pytest.mark.parametrize('assignment', EXAMINED)
def test_every_section_to_read_is_a_heading_of_a_lesson(assignment, hidden):
    """Otherwise the link would be dead; a section of another lesson is named without a link."""
    headings = lesson_headings(HERE.notebooks)

    assert headings.keys() >= set(EXAMINED)
    for exam in catalog.for_assignment(assignment, hidden):
        assert list(read_mistakes(exam, headings)) == []


def test_every_section_about_an_exception_is_a_heading():
    """After an exception, the judge replaces the check's own section with this one."""
    headings = lesson_headings(HERE.notebooks)

    for section in HERE.facts.sections:
        assert no_section(section, '', headings) == ''


def test_results_with_pictures_survive_json(result):
    """The child process of a visible check returns them as JSON, and reports store JSON, too."""
    again = type(result).from_json(json.loads(json.dumps(result.to_json())))

    assert again == result
    assert any(exam.pictures for exam in again.exams)


def test_the_sample_is_there():
    """If the folder of the sample is renamed, its name in this file must change too."""
    assert (Path(HERE.sample_class) / ASSIGNMENT / SAMPLE).is_dir()
