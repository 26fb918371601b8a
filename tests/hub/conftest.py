"""
Install one hub for all tests, and start it for each test file.

The hub's accounts are removed after the tests.  ``HUB_TEST_FOLDER`` names a folder that is kept
together with the accounts, so that the next preparation takes seconds.
"""

from collections.abc import Iterator
import os
from pathlib import Path
import shutil
import subprocess
import tempfile

import pytest

from tests.hub.running_hub import ANN, BOB, Hub, running, TEACHER

BROWSERS = ('chromium', 'chromium-browser', 'google-chrome')
ARGUMENTS = ('--no-sandbox', '--disable-gpu', '--disable-background-networking')


@pytest.fixture(scope='session')
def folder() -> Iterator[Path]:
    """Return the folder of the hub's installation."""
    assert os.geteuid() == 0, 'A hub needs root. Try: sudo make test-hub'
    kept = os.environ.get('HUB_TEST_FOLDER')
    folder = Path(kept or tempfile.mkdtemp(prefix='hubtest-', dir='/srv'))
    folder.mkdir(exist_ok=True)
    folder.chmod(0o755)
    try:
        yield folder
    finally:
        if not kept:
            shutil.rmtree(folder)
            for user in (TEACHER, ANN, BOB):
                subprocess.run(['userdel', '--remove', user], capture_output=True, check=False)


@pytest.fixture(scope='module')
def hub(folder: Path, request: pytest.FixtureRequest) -> Iterator[Hub]:
    """Return a running hub, with the module's ``IDLE_MINUTES``, and a headless Chromium."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    assert found, 'No browser. Try: sudo apt-get install -y chromium'
    from playwright.sync_api import sync_playwright

    idle_minutes = getattr(request.module, 'IDLE_MINUTES', 60)
    with running(folder, idle_minutes) as settings, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=list(ARGUMENTS))
        yield Hub(settings, browser)
        browser.close()
