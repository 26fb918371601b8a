"""The book shows the students' text and the outputs of solved lessons, but no solution."""

import re

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
import pytest

from autograder.authoring.book import pages
from autograder.authoring.book.pages import first_page, INDEX, page, YOURS
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import marks_of
from environment.places import PROJECT

LESSONS = lesson_files(PROJECT / 'notebooks')
PICTURE = {'text/plain': 'a graph', 'text/html': '<svg/>'}


def lesson(*cells):
    metadata = {'language_info': {'name': 'python'}}
    return new_notebook(cells=list(cells), metadata=metadata)


def made(*outputs, source='show()', **marks):
    """Return the page's cells for a lesson that has one cell with these outputs."""
    metadata = {'nbgrader': marks} if marks else {}
    one = new_code_cell(source, id='one', metadata=metadata)
    solved = new_code_cell('the solution', id='one', outputs=list(outputs))
    return page(lesson(one), lesson(solved)).cells


def test_pages_can_be_written_again(tmp_path, monkeypatch):
    layout = Layout(tmp_path)
    monkeypatch.setattr(pages, 'executed', lambda path, config: nbformat.read(path, as_version=4))
    for folder in (layout.solutions, layout.notebooks):
        (folder / '01_x').mkdir(parents=True)
        text = nbformat.writes(lesson(new_markdown_cell('# Title', id='a')))
        (folder / '01_x' / 'x.ipynb').write_text(text)

    for _ in range(2):
        pages.write_pages(layout, tmp_path / 'book')

    assert (tmp_path / 'book' / '01_x' / 'x.ipynb').is_file()


def test_demonstration_has_its_picture():
    """The page keeps the best form of each output that works without a kernel."""
    widget = {'application/vnd.jupyter.widget-view+json': {}, 'text/html': '<p>?</p>'}
    (cell,) = made(new_output('display_data', PICTURE), new_output('display_data', widget))

    assert [one.data for one in cell.outputs] == [
        {'text/html': '<svg/>'},
        {'text/html': '<p>?</p>'},
    ]


def test_line_that_was_cleared_is_left_out():
    (cell,) = made(new_output('display_data', {'text/plain': ''}), new_output('stream', text='a'))

    assert [one.output_type for one in cell.outputs] == ['stream']


def test_exercise_keeps_its_stub_and_has_no_output():
    """A line after an exercise says that the outputs come from a correct answer."""
    marks = {'nbgrader': {'solution': True, 'grade_id': 'one'}}
    output = new_output('stream', text='x')
    release = [new_code_cell('# YOUR CODE HERE', id=name, metadata=marks) for name in 'ab']
    release += [new_code_cell('look', id='c'), new_code_cell('again', id='d')]
    solved = [new_code_cell('x', id=name, outputs=[output]) for name in 'abcd']
    cells = page(lesson(*release), lesson(*solved)).cells

    assert [cell.get('source') for cell in cells] == [
        *('# YOUR CODE HERE', '# YOUR CODE HERE', YOURS, 'look', 'again')
    ]
    assert [cell.get('outputs', []) for cell in cells] == [[], [], [], [output], [output]]


def test_diagram_becomes_its_words_and_links_lead_to_the_first_page():
    """The pages work without scripts, so a diagram is shown as text."""
    text = (
        '# A\n\n```mermaid\nflowchart LR\n  accTitle: Two\n  accDescr: A to B.\n  A --> B\n```\n'
    )
    text += '[Start](../START_HERE.ipynb)'
    (cell,) = page(lesson(new_markdown_cell(text, id='a')), lesson()).cells

    assert cell.source == f'# A\n\n> **Two.** A to B.\n[Start](../{INDEX})'


@pytest.mark.parametrize('path', LESSONS, ids=lambda path: path.stem)
def test_page_of_a_lesson_has_no_line_of_a_solution(path):
    solved = nbformat.read(PROJECT / 'solutions' / path.parent.name / path.name, as_version=4)
    released = nbformat.read(path, as_version=4)
    known = {line.strip() for cell in released.cells for line in cell.source.splitlines()}
    secret = {
        line.strip()
        for cell in solved.cells
        if marks_of(cell).get('solution')
        for part in re.findall('BEGIN SOLUTION(.*?)### END', cell.source, re.DOTALL)
        for line in part.splitlines()
    } - known
    result = page(released, solved)

    assert secret.isdisjoint(
        line.strip() for cell in result.cells for line in cell.source.splitlines()
    )
    assert 'mermaid' not in nbformat.writes(result)


def test_first_page_links_to_all_lessons():
    text = nbformat.writes(first_page(Layout(PROJECT)))

    assert [text.index(f'({path.parent.name}/{path.name})') for path in LESSONS] == sorted(
        text.index(f'({path.parent.name}/{path.name})') for path in LESSONS
    )
