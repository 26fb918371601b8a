"""Compare real endpoints with ``qos_check_compatible`` and with the documented rule."""

from collections import Counter
from itertools import product
import re

import pytest

from roslab.errors import RoslabError
from roslab.qos_table import CHOICES, documented, qos_table

pytestmark = pytest.mark.ros
SIDES = ('publisher', 'subscription')
OPEN = {'SYSTEM_DEFAULT', 'BEST_AVAILABLE'}
WEAK_TO_STRONG = {
    'reliability': ['BEST_EFFORT', 'RELIABLE'],
    'durability': ['VOLATILE', 'TRANSIENT_LOCAL'],
    'liveliness': ['AUTOMATIC', 'MANUAL_BY_TOPIC'],
    'deadline': ['no limit', '2 s', '1 s'],
    'lease': ['no limit', '2 s', '1 s'],
}
NAMED_IN_EVENT = {'lease': 'LIVELINESS'}


@pytest.fixture(scope='module', params=product(CHOICES, SIDES), ids=' '.join)
def table(request):
    """Return each table, in each order of creation."""
    policy, first = request.param
    return qos_table(policy, first=first)


def test_every_combination_is_tried_once(table):
    """The table has one cell per pair of choices, in order."""
    pairs = [(cell.offered, cell.requested) for cell in table.cells]

    assert pairs == list(product(CHOICES[table.policy], repeat=2))


def test_plain_values_do_what_check_and_documentation_say(table):
    """OK means a match and ERROR none, in every cell whose values are all determined."""
    plain = [cell for cell in table.cells if not {cell.offered, cell.requested} & OPEN]
    assert plain
    for cell in plain:
        assert (cell.check, cell.documented) == (
            ('OK', True) if cell.matched else ('ERROR', False)
        ), str(cell)


def test_documented_rule_is_that_of_offer_and_request(table):
    """The test restates the rule: the offer is at least as strong as the request."""
    order = WEAK_TO_STRONG.get(table.policy)
    if order is None:
        expected = {True, False} if table.policy == 'reliability and durability' else {True}
        assert {cell.documented for cell in table.cells} == expected
        return
    for (weak, offered), (strong, requested) in product(enumerate(order), repeat=2):
        assert documented(table.policy, offered, requested) == (weak >= strong)


def test_every_refusal_is_reported_to_both_sides_with_the_policy(table):
    """A refusal gives the publisher and the subscription one event each; a match gives none."""
    for cell in table.cells:
        assert len(cell.refused_for) == (0 if cell.matched else 2), str(cell)
        named = set(cell.refused_for)
        if table.policy == 'reliability and durability':
            assert named <= {'RELIABILITY', 'DURABILITY'}
        elif named:
            assert named == {NAMED_IN_EVENT.get(table.policy, table.policy.upper())}


def test_every_difference_is_an_explained_one(table):
    """Only undetermined values cause a difference, and the explanation names the value."""
    for cell in table.disagreements:
        assert cell.check == 'WARNING' or 'BEST_AVAILABLE' in (cell.offered, cell.requested)
        assert cell.explanation, str(cell)
        assert set(re.findall(r'SYSTEM_DEFAULT|BEST_AVAILABLE', cell.explanation)) <= {
            cell.offered,
            cell.requested,
        }


def test_system_default_is_what_a_warning_is_about():
    """WARNING means undetermined: the middleware may refuse or accept the pair."""
    warned = {cell.matched for cell in qos_table('liveliness').cells if cell.check == 'WARNING'}

    assert warned == {True, False}


@pytest.mark.parametrize(('first', 'matched'), [('publisher', True), ('subscription', False)])
def test_best_available_depends_on_who_comes_first(first, matched):
    """A subscription adapts to an existing best-effort publisher, but not to a later one."""
    cell = qos_table('reliability', first=first)['BEST_EFFORT', 'BEST_AVAILABLE']

    assert (cell.matched, cell.check, cell.agrees) == (matched, 'OK', matched)


def test_table_is_read_without_colours():
    """The table has a caption, header cells with a scope, and each outcome in words."""
    table = qos_table('deadline')
    page = table._repr_html_()

    assert '<caption>Deadline: 9 pairs, 6 matched' in page
    assert (page.count('scope="col"'), page.count('scope="row"')) == (4, 3)
    assert page.count('✗ no: DEADLINE') == repr(table).count('✗ no: DEADLINE') == 3
    assert page.count('✓ match') == repr(table).count('✓ match') == 6


def test_match_and_refusal_have_different_colours():
    """The tints are transparent, so that text stays readable on light and dark pages."""
    page = qos_table('deadline')._repr_html_()
    tints = re.findall(r'background: (#\w+)">(?:<b>)?(.)', page)

    assert Counter(tints) == {('#43a04729', '✓'): 6, ('#e5393529', '✗'): 3}


def test_unknown_table_is_refused_with_the_known_ones():
    """The error lists the known tables."""
    with pytest.raises(RoslabError, match=r"'lease'.*got 'speed'"):
        qos_table('speed')
    with pytest.raises(RoslabError, match='first'):
        qos_table('depth', first='both')
