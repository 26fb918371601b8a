"""The text of a check: complete, short, and the same in a terminal and in HTML."""

from dataclasses import replace
import html
import re

from bs4 import BeautifulSoup
import pytest

from autograder.explaining.feedback import (
    causes_once,
    check_lines,
    exam_text,
    feedback_items,
    MOST_LINES,
    WIDTH,
)
from autograder.explaining.feedback_html import exam_html, section_id
from autograder.results import CheckResult, ExamResult, Verdict
from roslab.checking import CheckReport

LONG = 'The readings of the sensor that is far away from everything are late. ' * 30
EVIL = '<img src=x onerror=alert(1)>&"\x1b[31m'


def failing(**changes):
    facts = {
        'expected': 'one message every 0.5 s',
        'observed': '3 messages in 6 s',
        'cause': 'The period is 2.0 s.',
        'try_this': 'create_timer(0.5, ...)',
        'read': 'Part 2: Names',
    }
    return CheckResult(
        'rate', 'It speaks twice a second.', Verdict.FAILED, 0.5, 2, **{**facts, **changes}
    )


def test_a_failed_check_says_five_things_in_order():
    assert check_lines(failing()) == [
        '[FAIL] It speaks twice a second. (0.5 of 2)',
        '       expected: one message every 0.5 s',
        '       observed: 3 messages in 6 s',
        '       likely cause: The period is 2.0 s.',
        '       try: create_timer(0.5, ...)',
        '       read: Part 2: Names',
    ]


def test_what_is_not_known_is_not_said():
    assert [name for name, _ in feedback_items(failing(cause='', try_this=' '))] == [
        'expected',
        'observed',
        'read',
    ]


def test_a_check_that_waits_names_the_sentence_it_waits_for():
    waiting = CheckResult('text', 'It counts.', Verdict.NOT_RUN, 0, 1, waits_for='rate')

    first = replace(waiting, check='rate', title='It speaks.', waits_for='')
    both = causes_once(ExamResult('talker', (first, waiting)))

    assert [feedback_items(check) for check in both] == [[], [('waits for', 'It speaks.')]]
    assert feedback_items(waiting) == [('waits for', 'rate')]


@pytest.mark.parametrize('name', ['expected', 'observed', 'cause', 'try_this'])
@pytest.mark.parametrize('text', [LONG, 'x' * 3000, 'word\n' * 300])
def test_twelve_lines_are_enough_for_any_text(name, text):
    lines = check_lines(failing(**{name: text}))

    assert len(lines) <= MOST_LINES
    assert max(map(len, lines)) <= WIDTH
    assert '\N{HORIZONTAL ELLIPSIS}' in ' '.join(lines)
    assert lines[-1] == '       read: Part 2: Names'


def test_all_parts_may_be_long():
    check = failing(**dict.fromkeys(('expected', 'observed', 'cause', 'try_this', 'read'), LONG))

    assert len(check_lines(check)) <= MOST_LINES
    assert len(feedback_items(check)) == 5


def test_cause_is_printed_once_and_then_referred_to():
    first = failing()
    again = replace(first, check='again', title='It speaks for a minute.')
    other = replace(again, check='other', try_this='Call spin().')
    passed = CheckResult('a', 'A.', Verdict.PASSED, 1, 1)
    result = ExamResult('talker', (passed, passed, first, again, other))
    page = html.unescape(exam_html(result))

    for said in (exam_text(result), page, str(CheckReport('talker', result))):
        assert said.count('The period is 2.0 s.') == 1
        assert said.count('create_timer(0.5, ...)') == 1
        assert said.count('the same as above, for: It speaks twice a second.') == 2
        assert 'Call spin().' in said


def test_points_stay_together():
    for length in range(60, 90):
        check = CheckResult('a', f'{"x " * (length // 2)}end.', Verdict.PASSED, 1, 1)

        assert '(1 of 1)' in '\n'.join(check_lines(check))


@pytest.mark.parametrize('text', ['short', LONG, EVIL])
def test_html_says_the_same_words(text):
    check = failing(observed=text)
    soup = BeautifulSoup(exam_html(ExamResult('talker', (check,))), 'html.parser')
    facts = [(name.text, text.text) for name, text in zip(soup('dt'), soup('dd'))]

    assert facts == feedback_items(check)


def test_words_of_a_program_stay_words():
    result = ExamResult('talker', (failing(observed=EVIL, cause=EVIL, read=EVIL),), note=EVIL)
    page = exam_html(result, lessons={'': ''})

    assert not BeautifulSoup(page, 'html.parser')('img')
    assert '\x1b' not in page + exam_text(result)


def test_the_section_to_read_is_a_link_where_there_is_a_lesson():
    result = ExamResult('talker', (failing(),))

    lessons = {'': 'topics.ipynb', '08': '../08_what_went_wrong/what_went_wrong.ipynb'}
    elsewhere = ExamResult('talker', (failing(read='lesson 08, Part 7: Logging and parameters'),))

    assert 'href="#Part-2:-Names"' in exam_html(result, lessons={'': ''})
    assert 'href="topics.ipynb#Part-2:-Names"' in exam_html(result, lessons=lessons)
    assert 'href' not in exam_html(result)
    assert f'href="{lessons["08"]}#Part-7:-Logging-and-parameters"' in exam_html(
        elsewhere, lessons=lessons
    )
    assert 'href' not in exam_html(elsewhere, lessons={'': ''})
    for read, end in (('When a timer ticks', '#When-a-timer-ticks"'), ('on clocks', '"')):
        subject = ExamResult('talker', (failing(read=f'lesson 08, {read}'),))
        assert f'href="{lessons["08"]}{end}' in exam_html(subject, lessons=lessons)
    assert section_id('A  "b" <c>') == 'A-%22b%22-%3Cc%3E'


def test_no_colour_says_anything_alone():
    page = exam_html(ExamResult('talker', (failing(),)))

    assert '\N{BALLOT X} Failed:' in html.unescape(re.sub('<[^>]+>', '', page))
