"""
JUnit XML that follows the schema of Jenkins' xUnit plugin (junit-10.xsd).

``RULES`` lists its elements, children and attributes.  Readers also rely on numbers that add up,
and on a unique name for each case.
"""

import re
from xml.etree import ElementTree

from export_world import ABSENT, CLASS, marked, REVIEW, submission
from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.results_of_class import ClassResults
from autograder.exports.junit import clean, junit_xml

TIME = re.compile(r'^(([0-9]{0,3},)*[0-9]{3}|[0-9]{0,3})*(\.[0-9]{0,3})?$')
WORDS = {'type', 'message'}
RULES = {
    'testsuites': ({'testsuite'}, set(), {'name', 'time', 'tests', 'failures', 'errors'}),
    'testsuite': (
        {'testsuite', 'properties', 'testcase', 'system-out', 'system-err'},
        {'name', 'tests', 'failures', 'errors'},
        {'group', 'time', 'skipped', 'timestamp', 'hostname', 'id', 'package', 'file', 'log'},
    ),
    'testcase': (
        {'skipped', 'error', 'failure', 'system-out', 'system-err'},
        {'name'},
        {'time', 'classname', 'group'},
    ),
    'failure': (set(), set(), WORDS),
    'error': (set(), set(), WORDS),
    'skipped': (set(), set(), WORDS),
    'system-out': (set(), set(), set()),
}
"""Element -> permitted child elements, required attributes, optional attributes."""


def read(*results, absent=()):
    data = junit_xml(marked(ClassResults('01_talker', results), *absent))
    root = ElementTree.fromstring(data)  # noqa: S314
    assert root.tag == 'testsuites'
    for element in root.iter():
        children, required, allowed = RULES[element.tag]
        assert {child.tag for child in element} <= children, element.tag
        assert required <= set(element.attrib) <= required | allowed, element.tag
        assert TIME.match(element.get('time', '0'))
    for suite in (root, *root):
        for name, tag in (('failures', 'failure'), ('errors', 'error'), ('skipped', 'skipped')):
            if name in suite.attrib:
                assert int(suite.get(name)) == len(list(suite.iter(tag)))
        assert int(suite.get('tests')) == len(list(suite.iter('testcase')))
    names = [(case.get('classname'), case.get('name')) for case in root.iter('testcase')]
    assert len(set(names)) == len(names)
    return root


def test_verdicts_become_passed_failure_and_skipped():
    (suite,) = read(submission())
    runs, warns, stops = suite.findall('testcase')

    assert list(runs) == []
    assert warns.find('failure').get('message') == 'a typo'
    assert warns.find('failure').get('type') == 'typo'
    assert 'expected: one\nobserved: none' in warns.find('failure').text
    assert stops.find('skipped').get('message') == 'waits for warns'
    assert suite.get('time') == '1.251'


def test_for_review_is_an_error_of_its_own():
    _, suite = read(REVIEW)

    assert (suite.get('errors'), suite.get('failures')) == ('1', '0')
    error = suite.find('testcase/error')
    assert error.get('type') == 'for_review'
    assert error.get('message').startswith('The probe broke off.')


def test_a_class_keeps_the_rules_whatever_it_wrote():
    root = read(*CLASS.results)

    assert [len(list(suite)) > 0 for suite in root] == [True] * 5
    assert root.find('.//script') is None


@pytest.mark.parametrize('character', ['\x00', '\x0b', '\x1b', '\ud800', '\ufffe', '\uffff'])
def test_what_xml_does_not_have_is_replaced(character):
    """A character outside the production Char of XML 1.0, section 2.2, is replaced."""
    assert clean(f'a{character}b') == 'a\N{REPLACEMENT CHARACTER}b'


@settings(deadline=None, max_examples=40)
@given(strategies.text(strategies.characters()))
def test_any_words_give_a_document(words):
    read(submission(student=words, fault=words), submission('other'))


def test_a_student_without_a_submission_is_skipped():
    """A missing student is skipped, because nothing was tested."""
    root = read(*CLASS.results, absent=(ABSENT,))
    (case,) = root.findall('testsuite[@name="01_talker/zoe/missing"]/testcase')

    assert case.find('skipped').get('message') == 'nothing handed in'
