"""The book in a browser is accessible, fits a phone, and loads nothing from other hosts."""

from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
import os
from pathlib import Path
import subprocess
import sys
from threading import Thread
from typing import Any

from accessibility import violations
from conftest import ROOT
import pytest

from autograder.authoring.book.__main__ import build
from autograder.authoring.book.pages import write_pages
from autograder.layout import Layout

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]

REQUIREMENTS = ROOT / 'environment' / 'requirements-book.txt'
OF_THE_THEME = ('landmark-unique',)
"""Furo has two nameless sidebars."""
SLOW = ('color-contrast',)
"""This rule takes four times as long as all others; phone and wide page have equal colours."""
NARROW, WIDE = 400, 1400
A4_WIDTH = 794
"""Pixels at 96 dpi."""
PRINTED = (
    '00_quick_tour/quick_tour',
    '03_topics/topics',
    '05_quality_of_service/quality_of_service',
)
CUT_OFF = """() => [...document.querySelectorAll('article pre, article svg, article table')]
    .filter(one => one.getBoundingClientRect().right > window.innerWidth + 1)
    .map(one => one.outerHTML.slice(0, 200))"""
WIDER_THAN_THE_PAGE = 'document.documentElement.scrollWidth > window.innerWidth'


@pytest.fixture(scope='session')
def book(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the HTML of a book from `make book`, or of the existing one that BOOK names."""
    if there := os.environ.get('BOOK'):
        return Path(there)
    folder = tmp_path_factory.mktemp('book')
    subprocess.run([sys.executable, '-m', 'venv', folder / 'venv'], check=True)
    python = folder / 'venv' / 'bin' / 'python'
    install = ['-m', 'pip', 'install', '-q', '--no-deps', '--require-hashes', '-r', REQUIREMENTS]
    subprocess.run([python, *install], check=True)
    write_pages(Layout(ROOT), folder / 'pages')
    assert build(str(python), folder / 'pages', folder / 'html') == 0
    return folder / 'html'


@pytest.fixture
def address(book: Path) -> Iterator[str]:
    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: Any) -> None:
            """Print nothing."""

    with ThreadingHTTPServer(('127.0.0.1', 0), partial(Quiet, directory=str(book))) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f'http://127.0.0.1:{server.server_port}'
        server.shutdown()


@pytest.mark.parametrize('scheme', ['light', 'dark'])
def test_every_page_is_accessible_and_loads_nothing_from_elsewhere(
    book: Path, address: str, browser: Any, shots: Path, scheme: str
) -> None:
    """The test uses a wide page and a phone."""
    context = browser.new_context(bypass_csp=True, color_scheme=scheme)
    page, asked = context.new_page(), []
    page.on('request', lambda request: asked.append(request.url))
    found = {}
    for path in sorted(book.glob('*/*.html')) + [book / 'index.html']:
        name = path.relative_to(book).as_posix()
        page.goto(f'{address}/{name}')
        for width, ignored in ((WIDE, OF_THE_THEME), (NARROW, (*OF_THE_THEME, *SLOW))):
            page.set_viewport_size({'width': width, 'height': 900})
            found[name, width] = violations(page, *ignored)
            page.screenshot(path=shots / f'{path.stem}-{scheme}-{width}.png')
        assert not page.evaluate(WIDER_THAN_THE_PAGE), name
    context.close()

    assert {name: one for name, one in found.items() if one} == {}
    assert len(found) == 2 * (len(list((ROOT / 'notebooks').glob('*/*.ipynb'))) + 1)
    assert [url for url in asked if not url.startswith((address, 'data:'))] == []


@pytest.mark.parametrize('lesson', PRINTED)
def test_page_fits_paper(address: str, page: Any, shots: Path, lesson: str) -> None:
    """On A4, folded content is open, and no line is cut off."""
    page.set_viewport_size({'width': A4_WIDTH, 'height': 1123})
    page.emulate_media(media='print')
    page.goto(f'{address}/{lesson}.html')
    page.pdf(path=shots / 'printed.pdf', format='A4')
    data = page.locator('.cell_output details table').first

    assert data.bounding_box()['height'] > 0
    assert page.locator('.skip-to-content').is_hidden()
    assert page.evaluate(CUT_OFF) == []


def test_search_finds_a_word_of_a_lesson(address: str, page: Any) -> None:
    """The search needs no server."""
    from playwright.sync_api import expect

    page.goto(f'{address}/search.html?q=parleur')
    expect(page.locator('#search-results li').first).to_contain_text('Topics', timeout=30_000)
    assert page.errors == []


def test_picture_opens_its_data(address: str, page: Any) -> None:
    """The data can be opened with the keyboard."""
    page.goto(f'{address}/00_quick_tour/quick_tour.html')
    data = page.locator('details', has_text='Data of this picture').first
    data.locator('summary').press('Enter')

    assert data.locator('th').first.is_visible()
