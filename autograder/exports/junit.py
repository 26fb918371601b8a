"""
Write JUnit XML for CI servers: one suite per exam and submission, one case per check.

JUnit XML has no standard; this module writes what the schema of Jenkins' xUnit plugin
(junit-10.xsd) and the readers of Jenkins and GitLab have in common. A failed check is a
``failure``, a check that waits for another check is ``skipped``, and a submission for review is an
``error``: it has no verdict. A student without a submission is ``skipped``. XML 1.0 forbids most
control characters, even escaped ones, so they are replaced.
"""

from collections.abc import Iterable
import re
from xml.etree import ElementTree

from autograder.classroom.results_of_class import seconds_of_exam
from autograder.exports.marks import Mark
from autograder.results import CheckResult, Verdict

NO_XML = re.compile('[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]')
"""Characters that XML 1.0 does not allow (production ``Char`` in section 2.2)."""

COUNTS = {'tests': 'testcase', 'failures': 'failure', 'errors': 'error', 'skipped': 'skipped'}
"""The elements that each attribute of a suite counts."""


def junit_xml(marks: Iterable[Mark]) -> bytes:
    """Return the document, in UTF-8."""
    suites = ElementTree.Element('testsuites', name='autograder')
    for mark in marks:
        _add_suites(suites, mark)
    for suite in suites:
        for attribute, tag in COUNTS.items():
            suite.set(attribute, str(len(suite.findall(f'.//{tag}'))))
    for attribute in ('tests', 'failures', 'errors'):
        suites.set(attribute, str(len(suites.findall(f'.//{COUNTS[attribute]}'))))
    suites.set('time', f'{sum(float(suite.get("time", "0")) for suite in suites):.3f}')
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, encoding='utf-8', xml_declaration=True) + b'\n'


def clean(text: str) -> str:
    """Replace the characters that XML does not allow."""
    return NO_XML.sub('\N{REPLACEMENT CHARACTER}', text)


def _add_suites(suites: ElementTree.Element, mark: Mark) -> None:
    """Add the test suites of one student."""
    result = mark.result
    if result is None:
        case = _add_case(_add_suite(suites, mark, 'missing'), mark, 'submission')
        ElementTree.SubElement(case, 'skipped', message=clean(mark.status))
        return
    for exam in result.exams:
        suite = _add_suite(suites, mark, exam.exam, seconds_of_exam(exam))
        for check in exam.checks:
            _add_verdict(_add_case(suite, mark, f'{exam.exam}/{check.check}'), check)
        said = [problem.line() for problem in result.problems]
        said += [text for text in (exam.note, *exam.flags) if text]
        if said:
            ElementTree.SubElement(suite, 'system-out').text = clean('\n'.join(said))
    if result.review:
        case = _add_case(_add_suite(suites, mark, 'for review'), mark, 'grading')
        error = ElementTree.SubElement(case, 'error', message=clean(result.review))
        error.set('type', 'for_review')
        error.text = 'There is no score. A person must decide.'


def _add_suite(
    suites: ElementTree.Element, mark: Mark, name: str, seconds: float = 0.0
) -> ElementTree.Element:
    """Add a test suite without cases; its counts are set when it is complete."""
    where = clean(f'{mark.assignment}/{mark.student}/{name}')
    attributes = {'name': where, **dict.fromkeys(COUNTS, ''), 'time': f'{seconds:.3f}'}
    return ElementTree.SubElement(suites, 'testsuite', attributes)


def _add_case(suite: ElementTree.Element, mark: Mark, name: str) -> ElementTree.Element:
    """Add a case; its class name and name are unique in the class of students."""
    where = clean(f'{mark.assignment}.{mark.student}')
    return ElementTree.SubElement(suite, 'testcase', classname=where, name=clean(name))


def _add_verdict(case: ElementTree.Element, check: CheckResult) -> None:
    """Add to a case why its check has not passed; a failure contains the feedback as text."""
    if check.verdict is Verdict.FAILED:
        message = check.cause or check.observed or check.title
        failure = ElementTree.SubElement(case, 'failure', message=clean(message))
        failure.set('type', clean(check.cause_id) or 'failed')
        points = f'{check.points:g} of {check.max_points:g}'
        facts = {'checked': check.title, **check.facts, 'points': points}
        failure.text = clean('\n'.join(f'{name}: {text}' for name, text in facts.items()))
    elif check.verdict is Verdict.NOT_RUN:
        ElementTree.SubElement(case, 'skipped', message=clean(f'waits for {check.waits_for}'))
