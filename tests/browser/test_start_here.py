"""
The page that `make lab` opens, and the links of a lesson.

    make test-browser ARGS='-k start_here'
"""

import json
import re
from typing import Any

from conftest import Lab
from lab_page import CELL_MS, OPEN_MS, open_notebook, run_all, TROUBLE, WITHOUT_WORDS
import pytest

from autograder.layout import lesson_files
from autograder.submission.outline import read_outline

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]


def test_lab_opens_start_here_and_its_links_lead_to_lessons(
    lab: Lab, page: Any, shots: Any
) -> None:
    """Without a path in the address, a student sees the map and follows two links."""
    from playwright.sync_api import expect

    page.goto(f'{lab.address}?token={lab.token}')
    # JupyterLab may first show a notebook of an earlier test.
    tab = page.locator('#jp-main-dock-panel .lm-TabBar-tab.lm-mod-current', has_text='START_HERE')
    expect(tab).to_be_visible(timeout=OPEN_MS)
    ready = page.locator('#jp-main-statusbar', has_text='ROS 2 Jazzy | Idle')
    expect(ready).to_be_visible(timeout=OPEN_MS)
    run_all(page)
    # A notebook of an earlier test may be open, but hidden.
    shown = page.locator('.jp-NotebookPanel:not(.lm-mod-hidden) .jp-OutputArea-output')
    expect(shown).to_contain_text(re.compile(r'\d+ of \d+ points; next: lesson'), timeout=CELL_MS)
    shown.scroll_into_view_if_needed()
    page.screenshot(path=shots / 'start_here.png')
    assert page.evaluate(WITHOUT_WORDS) == []

    shown.get_by_role('link', name='next: lesson').click()
    contents = page.locator('.jp-MarkdownCell', has_text='In this lesson.')
    expect(contents).to_be_visible(timeout=OPEN_MS)
    heading = page.get_by_role('heading', name='Part 3')
    expect(heading).not_to_be_in_viewport()
    contents.get_by_role('link', name='Part 3').click()
    expect(heading).to_be_in_viewport()
    page.screenshot(path=shots / 'part_3.png')
    assert page.locator(TROUBLE).all_inner_texts() == []
    assert page.errors == []


def test_progress_leads_to_a_part_of_a_notebook_that_is_not_open(
    gradual_lab: Lab, page: Any, shots: Any
) -> None:
    """The learner has done everything except Part 3 of lesson 05, far below the first screen."""
    from playwright.sync_api import expect

    lessons = [read_outline(path) for path in lesson_files(gradual_lab.course / 'notebooks')]
    (lesson,) = (one for one in lessons if one.number == '05')
    (left,) = (part for part in lesson.parts if part.heading.startswith('Part 3:'))
    parts = [part for one in lessons for part in one.parts if part is not left]
    results = {
        'checks': {name: points for part in parts for name, points in part.checks.items()},
        'quizzes': {key: 1 for part in parts for key in part.quizzes},
    }
    remembered = gradual_lab.course / 'autograder' / '_work' / 'progress.json'
    remembered.write_text(json.dumps(results), encoding='utf-8')

    open_notebook(gradual_lab, page, 'notebooks/START_HERE.ipynb')
    run_all(page)
    remembered.unlink()
    expect(page.locator('.jp-NotebookPanel')).to_have_count(1)
    page.get_by_role('link', name='next: lesson 05, Part 3').click(timeout=CELL_MS)

    # Whatever is drawn later above the heading must not move it out of view.
    opened = page.locator('.jp-NotebookPanel:not(.lm-mod-hidden)')
    cells = json.loads(lesson.path.read_text(encoding='utf-8'))['cells']
    expect(opened.locator('.jp-Notebook-cell')).to_have_count(len(cells), timeout=OPEN_MS)
    expect(opened.locator('.jp-RenderedMermaid img')).to_be_attached(timeout=OPEN_MS)
    expect(page.get_by_role('heading', name=left.heading)).to_be_in_viewport()
    page.screenshot(path=shots / 'part_3.png')
    assert page.errors == []
