"""What cells show in JupyterLab can be read by everyone, on a light and on a dark page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from accessibility import violations
from conftest import Lab
from lab_page import choose, open_notebook, run_all, solved
import pytest

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

OUTPUTS = '.jp-OutputArea-output'
DARK = 'body[data-jp-theme-light="false"]'


def test_outputs_of_a_lesson_are_accessible(lab: Lab, browser: Any, shots: Path) -> None:
    """Pictures with their data, questions and lines of logs."""
    context = browser.new_context(bypass_csp=True, viewport={'width': 1360, 'height': 900})
    page = context.new_page()
    open_notebook(lab, page, solved(lab, '00_quick_tour'))
    run_all(page)
    data = page.locator(f'{OUTPUTS} details', has_text='Data of this picture')
    data.first.evaluate('one => { one.open = true }')
    found = {'light': violations(page, of=OUTPUTS)}
    data.first.scroll_into_view_if_needed()
    page.screenshot(path=shots / 'light.png')
    choose(page, 'Settings', 'Theme', 'JupyterLab Dark')
    page.locator(DARK).wait_for(state='attached')
    found['dark'] = violations(page, of=OUTPUTS)
    data.first.scroll_into_view_if_needed()
    page.screenshot(path=shots / 'dark.png')
    pictures = data.count()
    context.close()

    assert pictures == 3
    assert found == {'light': [], 'dark': []}
