"""The pages of a class are readable in a browser, on a phone and on a wide screen."""

from pathlib import Path
from typing import Any

from accessibility import violations
import pytest

from autograder.classroom.pages import write_all_reports
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict

pytestmark = pytest.mark.browser

ASSIGNMENT = '07_temperature_monitor'
NAMES = ('fail__prints_instead_of_logging', 'ann', 'student_2027_0123456789')
WORDS = 'It logs no warning for any other reading, not even for one that is exactly at the limit.'
TIMELINE = {
    'kind': 'timeline',
    'unit': 'seconds',
    'begin': 0.0,
    'end': 10.0,
    'rows': [{'label': 'a', 'what': 'observed', 'count': 2, 'times': [2.0, 4.0]}],
}
# Table cells whose longest word does not fit on one line.
BROKEN = """() => [...document.querySelectorAll('th, td, .name')]
    .filter(cell => cell.getBoundingClientRect().width > 0)
    .filter(cell => {
        const text = [...cell.childNodes].find(one => one.nodeType === Node.TEXT_NODE
            && one.data.trim()) || cell.querySelector('a')?.firstChild
        if (!text) return false
        const range = document.createRange()
        return [...text.data.matchAll(/\\w{2,40}/g)].some(word => {
            range.setStart(text, word.index)
            range.setEnd(text, word.index + word[0].length)
            return range.getClientRects().length > 1
        })
    })
    .map(cell => cell.textContent.trim())"""


def check(name: str) -> CheckResult:
    """Return a failed check."""
    return CheckResult(
        name, WORDS, Verdict.FAILED, 0, 2, observed='2 messages', cause=WORDS, cause_id='cause'
    )


@pytest.fixture(scope='module')
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    layout = Layout(tmp_path_factory.mktemp('course'))
    released = layout.notebooks / ASSIGNMENT / 'lesson.ipynb'
    released.parent.mkdir(parents=True)
    released.write_text('{}', encoding='utf-8')
    pictures = {'rate': TIMELINE, 'stamp': TIMELINE}
    exam = ExamResult('publisher', (check('rate'), check('stamp')), pictures=pictures)
    results = [SubmissionResult(name, ASSIGNMENT, (exam,)) for name in NAMES]
    return write_all_reports(layout, ASSIGNMENT, results).parent


@pytest.mark.parametrize('width', [400, 1400])
@pytest.mark.parametrize('page_name', ['class', 'students/ann'])
def test_page_is_readable_without_a_mouse(
    pages: Path, browser: Any, shots: Path, page_name: str, width: int
) -> None:
    """No word is broken, no element overflows, and axe reports no violation."""
    # The policy of the pages forbids every script, including axe.
    context = browser.new_context(viewport={'width': width, 'height': 900}, bypass_csp=True)
    page = context.new_page()
    page.goto((pages / f'{page_name}.html').as_uri())
    page.screenshot(path=shots / 'page.png', full_page=True)

    assert page.evaluate(BROKEN) == []
    assert page.evaluate(
        'document.documentElement.scrollWidth <= document.documentElement.clientWidth'
    )
    assert violations(page) == []
    context.close()
