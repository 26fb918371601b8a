"""Contents, links to the next lesson, and the map are generated from the outlines."""

import html
import json
from pathlib import Path
import re

import nbformat
from nbformat.v4 import new_markdown_cell, new_notebook
import pytest

from autograder.authoring import execute
from autograder.authoring.lesson_frame import (
    contents,
    lesson_map,
    next_lesson,
    outlines,
    START_HERE,
    start_here,
    unknown_needs,
)
from autograder.explaining.feedback_html import section_id
from autograder.layout import Layout, lesson_files
from autograder.submission.outline import read_outline
from roslab import output

LESSONS = lesson_files(Layout.here().notebooks)
LINK = re.compile(r'\]\(#([^)]+)\)')


def vscode_slug(text):
    """Return the id that VS Code gives to a heading, and to which it converts links."""
    slug = re.sub(r'\s+', '-', text.strip().lower())
    return re.sub(r"""[]\[!/'"#$%&()*+,./:;<=>?@\\^{|}~`]""", '', slug).strip('-')


@pytest.fixture
def solutions(tmp_path):
    """Return the sources of a course with three lessons; the last one needs the first one."""
    for name, metadata in (('01_a', {}), ('02_b', {}), ('03_c', {'lesson': {'needs': ['01']}})):
        cells = [new_markdown_cell(f'# Title {name[3:]}'), new_markdown_cell('## Part 1: Go')]
        folder = tmp_path / 'solutions' / name
        folder.mkdir(parents=True)
        nbformat.write(new_notebook(cells=cells, metadata=metadata), folder / f'{name[3:]}.ipynb')
    return folder.parent


def test_contents_name_what_a_lesson_needs(solutions):
    lessons = outlines(solutions)

    assert contents(lessons, 0).splitlines()[0] == '**In this lesson.**'
    assert 'First do [01 Title a](../01_a/a.ipynb).' in contents(lessons, 1)
    assert 'First do [01 Title a](../01_a/a.ipynb).' in contents(lessons, 2)
    assert contents(lessons, 2).endswith('\n\n* [Part 1: Go](#Part-1:-Go)')


def test_last_lesson_has_no_next_one(solutions):
    lessons = outlines(solutions)

    assert next_lesson(lessons, 1) == '*Next lesson:* [03 Title c](../03_c/c.ipynb)'
    assert next_lesson(lessons, 2) == 'This was the last lesson.'
    (solutions / 'START_HERE.ipynb').touch()
    assert '(../START_HERE.ipynb)' in next_lesson(lessons, 2)


def test_needed_lesson_that_does_not_exist_is_named(solutions):
    """Otherwise a typo in the metadata would leave the column empty."""
    lessons = outlines(solutions)

    assert list(unknown_needs(lessons[:2])) == []
    assert list(unknown_needs(lessons[1:])) == ['03_c: it needs lesson 01, which does not exist.']


def test_start_here_has_a_line_for_each_lesson(solutions, tmp_path):
    release = tmp_path / 'release'
    release.mkdir()
    start_here(solutions, release)
    assert list(release.iterdir()) == []
    cells = [new_markdown_cell('# Start', id='title'), new_markdown_cell('...', id='map')]
    nbformat.write(new_notebook(cells=cells), solutions / 'START_HERE.ipynb')
    start_here(solutions, release)
    written = nbformat.read(release / 'START_HERE.ipynb', as_version=4)

    assert [cell.source for cell in written.cells] == ['# Start', lesson_map(outlines(solutions))]
    assert '| [03 Title c](03_c/c.ipynb) | 01 |  |  |' in written.cells[1].source


def test_make_lab_opens_a_page_that_exists():
    root = Layout.here().root
    makefile = (root / 'Makefile').read_text(encoding='utf-8')
    found = re.search(r'default_url=/lab/tree/(\S+)', makefile)

    assert found
    assert (root / found[1]).is_file()


@pytest.mark.parametrize('path', LESSONS, ids=lambda path: path.stem)
def test_released_lesson_begins_with_contents_and_ends_with_the_next_lesson(path):
    cells = nbformat.read(path, as_version=4).cells
    outline = read_outline(path)
    shown = cells[1].source

    links = LINK.findall(shown)
    assert links == [section_id(part.heading) for part in outline.parts[1:]]
    slugs = [vscode_slug(part.heading) for part in outline.parts[1:]]
    assert [vscode_slug(link) for link in links] == slugs
    assert len({*slugs}) == len(slugs)
    assert shown.startswith(f'**In this lesson.** {outline.minutes} minutes. ')
    assert 'Last executed with ROS 2 ' in shown, f'Try: make execute ARGS={path.parent.name}'
    assert (cells[1].id, cells[-1].id) == ('lesson-contents', 'lesson-next')


@pytest.fixture
def shown(monkeypatch):
    """Return a function that returns a link as a frontend gets it."""

    def link(address, cell_id):
        cell = output.Cell(1, {'metadata': {'cellId': cell_id}})
        monkeypatch.setattr(output, 'current_cell', lambda: cell)
        return output._with_links(f'<a href="{html.escape(address)}">')

    return link


def test_links_in_outputs_open_no_second_copy_in_vscode(shown):
    """JupyterLab and VS Code give a heading different ids."""
    headings = [part.heading for path in LESSONS for part in read_outline(path).parts]
    assert len(headings) > 50
    for heading in headings:
        here, there = (f'{name}#{section_id(heading)}' for name in ('a.ipynb', '../02_b/b.ipynb'))
        vscode = 'vscode-notebook-cell:/course/a.ipynb#W0'

        assert html.unescape(shown(here, '5f2e')) == f'<a href="{here}">'
        assert shown(here, vscode) == f'<a href="#{vscode_slug(heading)}">'
        assert shown(there, vscode) == '<a href="../02_b/b.ipynb">'
    page = 'https://docs.ros.org/en/jazzy/index.html#nodes'
    assert shown(page, '5f2e') == shown(page, vscode) == f'<a href="{page}">'


@pytest.mark.parametrize('path', LESSONS, ids=lambda path: path.stem)
def test_links_in_outputs_lead_to_the_cell_of_a_heading_in_jupyterlab(path, shown, monkeypatch):
    """JupyterLab does not find the id of a heading that it has not drawn yet."""
    monkeypatch.chdir(LESSONS[0].parent)
    address = f'../{path.parent.name}/{path.name}'
    cells = nbformat.read(path, as_version=4).cells
    headings = {
        heading.replace('`', ''): cell.id
        for cell in reversed(cells)
        if cell.cell_type == 'markdown'
        for heading in re.findall('^##+ (.+)$', cell.source, re.MULTILINE)
    }
    assert len(headings) > 5
    for heading, cell_id in headings.items():
        link = f'{address}#{section_id(heading)}'
        assert shown(link, '5f2e') == f'<a href="{address}#cell-id={cell_id}">'
        assert html.unescape(shown(link, '')) == f'<a href="{link}">'


def test_links_in_outputs_remain_if_the_heading_is_not_found(shown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    other = new_notebook(cells=[new_markdown_cell('## Part 1')])
    old = {'cells': [{'cell_type': 'markdown', 'source': ['## Setup']}]}
    texts = (None, 'Not a notebook', '{"cells": [1]}', nbformat.writes(other), json.dumps(old))

    for number, text in enumerate(texts):
        if text is not None:
            Path(f'{number}.ipynb').write_text(text)
        link = f'{number}.ipynb#Setup'
        assert shown(link, '5f2e') == f'<a href="{link}">'


def test_start_here_names_the_points_that_a_person_gives():
    page = nbformat.read(Layout.here().notebooks / START_HERE, as_version=4)
    text = ' '.join(' '.join(cell.source for cell in page.cells).split())
    for path in LESSONS:
        cells = nbformat.read(path, as_version=4).cells
        marks = [cell.metadata.get('nbgrader', {}) for cell in cells]
        points = sum(one['points'] for one in marks if one.get('grade') and one.get('solution'))
        number = path.parent.name[:2]
        assert bool(points) == bool(re.search(rf'\b{points:g} in lesson {number}\b', text))


def test_executed_lesson_gets_the_date_and_no_outputs(solutions, monkeypatch):
    monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: Layout(solutions.parent)))

    class Client:
        """Fails in the second lesson."""

        def __init__(self, notebook, **options):
            self.notebook, self.folder = notebook, options['resources']['metadata']['path']

        async def async_execute(self):
            assert Path(self.folder).is_dir()
            if 'Title b' in self.notebook.cells[0].source:
                raise execute.CellExecutionError('Traceback', 'NameError', 'x')

    monkeypatch.setattr(execute, 'NotebookClient', Client)
    assert execute.main(['01_a', '02_b']) == 1
    first, second, third = outlines(solutions)

    assert re.fullmatch(r'with ROS 2 Jazzy on \d+ \w+ \d{4}', first.facts['executed'])
    assert second.facts == {}
    assert third.facts == {'needs': ['01']}
