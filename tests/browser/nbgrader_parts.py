"""The parts of nbgrader that a page of JupyterLab offers."""

from typing import Any

OPEN_MS = 60_000
CREATE = '.jp-SideBar [title*="Create Assignment"], .jp-SideBar [data-id*="create_assignment"]'


def offered(page: Any) -> set[str]:
    """Return the visible parts of nbgrader: menu entries, a panel, a button."""
    page.locator('.lm-MenuBar-itemLabel', has_text='Nbgrader').click()
    labels = page.locator('.lm-Menu-itemLabel')
    labels.filter(has_text='Assignment List').wait_for(timeout=OPEN_MS)
    found = {text for text in labels.all_inner_texts() if text}
    page.keyboard.press('Escape')
    if page.locator(CREATE).count():
        found.add('Create Assignment')
    if page.get_by_text('Validate', exact=True).count():
        found.add('Validate')
    return found
