"""
The page that `make lab` opens, and the links of a lesson.

    make test-browser ARGS='-k start_here'
"""

import re
from typing import Any

from conftest import Lab
from lab_page import CELL_MS, OPEN_MS, run_all, TROUBLE, WITHOUT_WORDS
import pytest

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
    shown = page.locator('.jp-OutputArea-output')
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
