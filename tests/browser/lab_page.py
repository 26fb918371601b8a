"""Actions of the tests on a page of JupyterLab: open a lesson, run it, find its cells."""

import json
from pathlib import Path
import re
from typing import Any

from conftest import Lab

OPEN_MS = 60_000
CELL_MS = 120_000
"""The longest wait for one event, such as the first build on a busy machine."""
LESSON_MS = 600_000
"""The longest wait for all cells of a lesson."""

TROUBLE = '[data-mime-type$="jupyter.error"], [data-mime-type$="jupyter.stderr"]'
"""Pink boxes."""
WITHOUT_WORDS = """() => {
    const said = ids => (ids ?? '').split(' ')
        .map(id => document.getElementById(id)?.textContent ?? '').join('').trim();
    const named = one => one.getAttribute('alt') || one.getAttribute('aria-label')
        || said(one.getAttribute('aria-labelledby'));
    const inside = kind => [...document.querySelectorAll(`.jp-OutputArea-output ${kind}`)];
    return [
        ...inside('svg').filter(one => one.getAttribute('role') !== 'img' || !named(one)),
        ...inside('img').filter(one => !named(one)),
        ...inside('th').filter(one => !one.textContent.trim() || !one.hasAttribute('scope')),
    ].map(one => one.outerHTML.slice(0, 300));
}"""
"""Finds unnamed pictures, and table headers without text or scope, in the outputs of cells."""
LAST_OR_TROUBLE = r"""trouble => document.querySelector(trouble) !== null
    || /^\[\d+\]:$/.test(
        [...document.querySelectorAll('.jp-NotebookPanel:not(.lm-mod-hidden) .jp-CodeCell')]
            .at(-1).querySelector('.jp-InputPrompt').textContent)"""
"""Looks only at the visible notebook: JupyterLab may have reopened those of earlier tests."""
HAS_RUN = re.compile(r'^\[\d+\]:$')


def open_notebook(lab: Lab, page: Any, path: str) -> None:
    """
    Open a notebook in an empty JupyterLab and wait for its cells and its kernel.

    :param path: path inside the course
    """
    from playwright.sync_api import expect

    cells = json.loads((lab.course / path).read_text(encoding='utf-8'))['cells']
    code = sum(cell['cell_type'] == 'code' for cell in cells)
    page.goto(lab.url(path))
    expect(page.locator('.jp-CodeCell')).to_have_count(code, timeout=OPEN_MS)
    # Without a kernel, Run All Cells does nothing and reports nothing.
    ready = page.locator('#jp-main-statusbar', has_text='ROS 2 Jazzy | Idle')
    expect(ready).to_be_visible(timeout=OPEN_MS)


def solved(lab: Lab, assignment: str) -> str:
    """Return the path of a lesson's solved notebook in the course."""
    (found,) = (lab.course / 'solutions' / assignment).glob('*.ipynb')
    return str(Path(found).relative_to(lab.course))


def choose(page: Any, *labels: str) -> None:
    page.locator(f'.lm-MenuBar-itemLabel:text-is("{labels[0]}")').click()
    for label in labels[1:]:
        page.locator(f'.lm-Menu-itemLabel:text-is("{label}")').click()


def cell_with(page: Any, *words: str) -> Any:
    found = page.locator('.jp-CodeCell')
    for word in words:
        found = found.filter(has=page.locator('.jp-InputArea', has_text=word))
    assert found.count() == 1, words
    return found


def wait_until_run(cell: Any, timeout: int = CELL_MS) -> None:
    from playwright.sync_api import expect

    expect(cell.locator('.jp-InputPrompt')).to_have_text(HAS_RUN, timeout=timeout)


def run_all(page: Any) -> None:
    """Run all cells, and assert that none of them fails or writes to stderr."""
    choose(page, 'Run', 'Run All Cells')
    page.wait_for_function(LAST_OR_TROUBLE, arg=TROUBLE, timeout=LESSON_MS)
    assert page.locator(TROUBLE).all_inner_texts() == []
