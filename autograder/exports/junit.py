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
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict

NO_XML = re.compile('[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]')
"""Characters that XML 1.0 does not allow (production ``Char`` in section 2.2)."""

COUNTS = {'failures': 'failure', 'errors': 'error', 'skipped': 'skipped'}


def junit_xml(marks: Iterable[Mark]) -> bytes:
    """Return the document, in UTF-8."""
    suites = ElementTree.Element('testsuites', name='autograder')
    for mark in marks:
        result = mark.result
        if result is None:
            suites.append(
                _single_case_suite(mark, 'missing', 'submission', 'skipped', mark.status)
            )
            continue
        suites.extend(_suite(result, exam) for exam in result.exams)
        if result.review:
            suites.append(
                _single_case_suite(mark, 'for review', 'grading', 'error', result.review)
            )
    for name in ('tests', 'failures', 'errors'):
        suites.set(name, str(sum(int(suite.get(name, '0')) for suite in suites)))
    suites.set('time', f'{sum(float(suite.get("time", "0")) for suite in suites):.3f}')
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, encoding='utf-8', xml_declaration=True) + b'\n'


def clean(text: str) -> str:
    """Replace the characters that XML does not allow."""
    return NO_XML.sub('\N{REPLACEMENT CHARACTER}', text)


def _suite(result: SubmissionResult, exam: ExamResult) -> ElementTree.Element:
    suite = _new_suite(f'{result.assignment}/{result.student}/{exam.exam}')
    for check in exam.checks:
        case = _case(suite, result.assignment, result.student, f'{exam.exam}/{check.check}')
        if check.verdict is Verdict.FAILED:
            message = check.cause or check.observed or check.title
            failure = ElementTree.SubElement(case, 'failure', message=clean(message))
            failure.set('type', clean(check.cause_id) or 'failed')
            failure.text = clean(_feedback_text(check))
        elif check.verdict is Verdict.NOT_RUN:
            ElementTree.SubElement(case, 'skipped', message=clean(f'waits for {check.waits_for}'))
    said = [problem.line() for problem in result.problems]
    said += [text for text in (exam.note, *exam.flags) if text]
    if said:
        ElementTree.SubElement(suite, 'system-out').text = clean('\n'.join(said))
    return _counted(suite, seconds_of_exam(exam))


def _single_case_suite(
    mark: Mark, kind: str, name: str, tag: str, message: str
) -> ElementTree.Element:
    """Return a test suite with one case that has neither passed nor failed."""
    suite = _new_suite(f'{mark.assignment}/{mark.student}/{kind}')
    case = _case(suite, mark.assignment, mark.student, name)
    about = ElementTree.SubElement(case, tag, message=clean(message))
    if tag == 'error':
        about.set('type', 'for_review')
        about.text = 'There is no score. A person must decide.'
    return _counted(suite, 0.0)


def _new_suite(name: str) -> ElementTree.Element:
    return ElementTree.Element('testsuite', name=clean(name))


def _case(
    suite: ElementTree.Element, assignment: str, student: str, name: str
) -> ElementTree.Element:
    """Add a case; its class name and name are unique in the class of students."""
    where = clean(f'{assignment}.{student}')
    return ElementTree.SubElement(suite, 'testcase', classname=where, name=clean(name))


def _counted(suite: ElementTree.Element, seconds: float) -> ElementTree.Element:
    """Set the counts of a test suite from its cases, and its time; return the suite."""
    suite.set('tests', str(len(suite.findall('testcase'))))
    for attribute, tag in COUNTS.items():
        suite.set(attribute, str(len(suite.findall(f'testcase/{tag}'))))
    suite.set('time', f'{seconds:.3f}')
    return suite


def _feedback_text(check: CheckResult) -> str:
    """Return the feedback on a check as text, one line per item."""
    points = f'{check.points:g} of {check.max_points:g}'
    facts = {'checked': check.title, **check.facts, 'points': points}
    return '\n'.join(f'{name}: {text}' for name, text in facts.items())
