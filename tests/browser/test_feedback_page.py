"""The feedback page of students, in a browser: accessible, complete and free of scripts."""

from pathlib import Path
from typing import Any

from accessibility import violations
import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
import pytest

from autograder.results import CheckResult, ExamResult, Verdict

pytestmark = [pytest.mark.browser, pytest.mark.nbgrader]

ROOT = Path(__file__).resolve().parents[2]
EVIL = '<img src="https://example.com/x.png" onerror="alert(1)"><script>alert(2)</script>'
LONG = '/a_topic_with_a_name_that_is_longer_than_anybody_would_ever_write_by_hand' * 3
GRAPH = {
    'kind': 'graph',
    'arrows': [
        {
            'node': '/talker',
            'topic': topic,
            'type': 'std_msgs/msg/String',
            'outward': True,
            'matched': matched,
            'remark': remark,
        }
        for topic, matched, remark in (
            ('/chatter', False, 'expected here, but missing'),
            (LONG, True, EVIL),
        )
    ],
}
TIMELINE = {
    'kind': 'timeline',
    'unit': 'seconds',
    'begin': 0.0,
    'end': 10.0,
    'rows': [
        {
            'label': 'expected',
            'what': 'expected',
            'count': 10,
            'times': [float(one) for one in range(1, 11)],
            'every_s': 1.0,
        },
        {'label': LONG, 'what': 'observed', 'count': 5, 'times': [2.0, 4.0, 6.0, 8.0, 10.0]},
    ],
    'deviation': 2.0,
}
OUTSIDE = """() => [...document.querySelectorAll('main *')]
    .filter(one => !one.closest('svg') && !one.closest('pre') && !one.closest('thead, tbody'))
    .filter(one => one.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
    .map(one => one.outerHTML.slice(0, 200))"""
WITHOUT_WORDS = """() => [...document.querySelectorAll('svg')]
    .filter(one => one.getAttribute('role') !== 'img'
        || !one.querySelector('title').textContent.trim()
        || !one.querySelector('desc').textContent.trim())
    .map(one => one.outerHTML.slice(0, 200))"""


def failing(name: str) -> CheckResult:
    """Return a failed check that contains a student's text."""
    return CheckResult(
        name,
        f'It does {name}.',
        Verdict.FAILED,
        0,
        2,
        expected='10 messages in 10 s',
        observed=EVIL + LONG,
        cause='Your node sends one message every 2 s.',
        try_this='create_timer(1.0, self.tick)',
        read='Part 2: Names',
    )


@pytest.fixture(scope='module')
def feedback(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a feedback page that nbgrader writes for this course."""
    from autograder.gradebook.database import load_config
    from autograder.gradebook.grade_cells import _feedback_output, _score
    from autograder.gradebook.nbgrader_plugin import FeedbackExporter
    from autograder.layout import Layout

    result = ExamResult(
        'talker',
        (
            CheckResult('runs', 'It runs.', Verdict.PASSED, 1, 1),
            failing('rate'),
            failing('topic'),
            CheckResult('stamp', 'It stamps.', Verdict.NOT_RUN, 0, 1, waits_for='topic'),
        ),
        pictures={'rate': TIMELINE, 'topic': GRAPH},
    )
    marks = {'grade': True, 'solution': False, 'points': 6.0, 'score': 1.0, 'task': False}
    answer = {**marks, 'grade': False, 'solution': True, 'grade_id': 'talker', 'comment': ''}
    node = new_code_cell(f'%%node talker\nx = "{LONG * 3}"', metadata={'nbgrader': answer})
    check = new_code_cell(
        "check('talker')",
        metadata={'nbgrader': {**marks, 'grade_id': 'check_talker', 'comment': EVIL}},
        outputs=[_feedback_output(result, ()), _score(1.0)],
        execution_count=1,
    )
    words = f'| topic | type |\n|---|---|\n| {LONG} | String |\n\n{"Some words. " * 400}'
    heading = new_markdown_cell(f'## Part 2: Names\n\n{words}\n\n### Self-check')
    again = new_markdown_cell('### Self-check')
    notebook = new_notebook(cells=[heading, again, node, check])
    nbformat.validate(notebook)
    late_result = {'notebook': 'topics', 'score': 1.0, 'max_score': 6.0, 'late_penalty': 0.5}
    exporter = FeedbackExporter(config=load_config(Layout(ROOT)))
    page, _ = exporter.from_notebook_node(notebook, resources={'nbgrader': late_result})
    path = tmp_path_factory.mktemp('feedback') / 'topics.html'
    path.write_text(page, encoding='utf-8')
    return path


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('width', [1280, 720, 360])
def test_a_feedback_page_fits_and_asks_for_nothing(
    feedback: Path, browser: Any, shots: Path, width: int, scheme: str
) -> None:
    """No element overflows, nothing is loaded, and no script runs."""
    context = browser.new_context(viewport={'width': width, 'height': 900}, color_scheme=scheme)
    page = context.new_page()
    asked: list[str] = []
    alerts: list[str] = []
    page.on('request', lambda request: asked.append(request.url))
    page.on('dialog', lambda dialog: (alerts.append(dialog.message), dialog.dismiss()))
    page.goto(feedback.as_uri())
    page.screenshot(path=shots / 'feedback.png', full_page=True)

    assert asked == [feedback.as_uri()]
    assert alerts == []
    assert page.evaluate(OUTSIDE) == []
    assert page.evaluate(
        'document.documentElement.scrollWidth <= document.documentElement.clientWidth'
    )
    background = page.evaluate('getComputedStyle(document.body).backgroundColor')
    assert (background == 'rgb(255, 255, 255)') == (scheme == 'light')
    context.close()


@pytest.mark.parametrize('width', [1280, 360])
def test_axe_finds_nothing_on_a_feedback_page(feedback: Path, browser: Any, width: int) -> None:
    """Elements that scroll have a name and can be focused, and no id is repeated."""
    # The page forbids every script, including axe.
    context = browser.new_context(viewport={'width': width, 'height': 900}, bypass_csp=True)
    page = context.new_page()
    page.goto(feedback.as_uri())

    assert violations(page) == []
    ids = page.evaluate('[...document.querySelectorAll("[id]")].map(one => one.id)')
    assert 'Self-check-2' in ids
    assert len(ids) == len(set(ids))
    context.close()


def test_everything_has_a_name(feedback: Path, page: Any) -> None:
    """Pictures have a description, and screen readers can jump to the checks and the lesson."""
    from playwright.sync_api import expect

    page.goto(feedback.as_uri())

    assert page.evaluate(WITHOUT_WORDS) == []
    expect(page.get_by_role('img', name='Observed events, against time')).to_have_count(1)
    expect(page.get_by_role('img', name='first difference at 2 s')).to_have_count(1)
    expect(page.get_by_role('img', name='expected here, but missing')).to_have_count(1)
    expect(page.get_by_role('region', name='Checks: talker')).to_have_count(1)
    expect(page.get_by_role('heading', level=1)).to_have_text('topics: 1 of 6 points')
    expect(page.get_by_role('navigation', name='What was graded')).to_contain_text(
        'Checks: talker, 1 of 6 points, with a comment'
    )
    page.get_by_role('link', name='Part 2: Names').first.click()
    heading = page.get_by_role('heading', name='Part 2: Names')
    expect(heading).to_be_in_viewport()
    assert page.errors == []
