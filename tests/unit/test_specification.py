"""A specification computes the correct answers and those of slips; inputs distinguish them."""

import math
import operator

import pytest

from autograder.exam import catalog
from autograder.exam.slips import warning_slips
from autograder.exam.specification import each, same, Slip, Specification


def above(hot=operator.gt, limit=30.0):
    """Return the rule that expects one warning for each number above the limit."""
    return each(lambda value: int(hot(value, limit)))


SLIPS = warning_slips(above, '30.0')


def asked(*inputs, burst=0):
    return Specification(inputs, above(), SLIPS, burst)


class TestCause:
    @pytest.mark.parametrize(
        ('came', 'cause_id'),
        [
            ([0, 1, 1, 1, 0, 0], 'warns_at_threshold'),
            ([1, 0, 0, 0, 1, 0], 'comparison_reversed'),
            ([0, 1, 1, 0, 1, 0], 'sign_ignored'),
            ([0, 1, 1, 0, 0, 1], 'nan'),
            ([0, 1, 0, 0, 0, 0], 'warns_once'),
            ([0, 1, 1, 1, 1, 1], 'warns_ever_after'),
            ([0, 2, 2, 0, 0, 0], 'repeated_warning'),
            ([1, 1, 1, 1, 1, 1], None),
        ],
    )
    def test_all_answers_have_to_be_those_of_the_slip(self, came, cause_id):
        found = asked(20.0, 31.0, 45.0, 30.0, -40.0, math.nan)
        place = found.wrong(came)[0]

        slip = found.cause(came, place)

        assert (slip and slip.cause_id) == cause_id

    def test_what_was_not_sent_is_no_answer(self):
        """If the run ended early, only the answers up to its end are compared."""
        found = asked(31.0, 30.0, 45.0)

        assert found.wrong([1, 1, None]) == [1]
        assert found.cause([1, 1, None], 1).cause_id == 'warns_at_threshold'

    def test_part_explains_where_a_second_mistake_spoils_the_rest(self):
        found, came = asked(math.nan, 20.0, 31.0, 30.0), [1, 0, 1, 1]

        assert found.cause(came, 3) is None
        assert found.cause(came, 3, [1, 2, 3]).cause_id == 'warns_at_threshold'
        assert found.cause(came, 0, [1, 2, 3]) is None

    def test_slip_that_happens_sometimes_explains_two_wrong_answers(self):
        late = Slip('late', '', '', each(lambda value: 1), sometimes=True)
        question = Specification((1, 2, 3, 40), above(), [late])

        assert question.cause([1, 0, 1, 1], 0) is late
        assert question.cause([1, 0, 0, 1], 0) is None
        assert question.cause([1, 0, 1, 0], 0) is None

    def test_burst_is_one_row_of_sums(self):
        """The answers to a burst are added, because they cannot be matched to its inputs."""
        found = asked(20.0, 31.0, 45.0, 30.0, burst=3)

        assert found.answers == [0, 2]
        assert list(found.row(1)) == [31.0, 45.0, 30.0]
        assert found.cause([0, 3], 1).cause_id == 'warns_at_threshold'
        tuples = Specification((3.0, 1.0), each(lambda one: (one,)), burst=2)
        assert tuples.answers == [(1.0, 3.0)]

    def test_throttled_warnings_are_part_of_a_burst(self):
        """Throttled warnings are correct for single inputs, but a burst gives only one warning."""
        inputs, (*_, slip) = (31.0, 20.0, 45.0, 31.0, 20.0), warning_slips(above, '30.0', 3)
        found = Specification(inputs, above(), [slip], burst=3)

        assert found.cause([1, 0, 1], 2).cause_id == 'part_of_a_burst'
        assert found.cause([1, 0, 0], 2) is None
        assert slip.cause_id not in {one.cause_id for one in SLIPS}

    def test_equal_message_that_is_skipped_is_not_a_change_or_a_maximum_only(self):
        found, rising = (
            asked(31.0, 31.0, 45.0, 20.0),
            asked(20.0, 45.0, math.nan, 31.0, 50.0, 50.0),
        )

        assert found.cause([1, 0, 1, 0], 1).cause_id == 'skips_equal'
        assert found.cause([1, 0, 0, 0], 1).cause_id != 'skips_equal'
        assert rising.cause([0, 1, 0, 0, 1, 0]).cause_id == 'warns_of_maxima'


class TestMistakes:
    """Inputs are invalid if a slip gives the correct answers, or those of another slip."""

    @pytest.mark.parametrize(
        ('inputs', 'pair'),
        [
            # Without the limit itself, no input shows whether it is included.
            ((29.0, 31.0), 'warns_at_threshold from the correct answers'),
            # With only one hot value, two slips give the same answers.
            ((20.0, 31.0), 'warns_of_changes from warns_once'),
        ],
    )
    def test_inputs_have_to_distinguish_all_slips(self, inputs, pair):
        assert f'no input distinguishes {pair}' in asked(*inputs).mistakes()

    def test_form_of_a_slip_and_an_exception_are_named(self):
        due = each(lambda one: one)
        slip = Slip('odd', '', '', each(lambda one: -one), each(lambda one: 1 / one), due)

        assert list(Specification([0, 3], due, [slip]).mistakes()) == [
            'the slip odd, form 2 raises ZeroDivisionError: division by zero',
            'no input distinguishes odd, form 3 from the correct answers',
        ]

    def test_two_of_one_name_may_look_alike(self):
        rule = each(lambda one: 0)
        slips = (Slip('none', 'text', 'try', rule), Slip('none', 'text', 'try', rule))

        assert list(Specification((31.0,), above(), slips).mistakes()) == []

    def test_another_secret_changes_nothing_for_those_who_grade(self):
        before = catalog.load('running_mean')

        other = catalog.load_with_secret('running_mean', 'another secret')

        assert catalog.load('running_mean') is before
        assert other.scenario != before.scenario


@pytest.mark.parametrize(
    ('one', 'other', 'equal'),
    [
        (math.nan, math.nan, True),
        (1.0, 1.0 + 1e-12, True),
        (1.0, 1.0 + 1e-6, False),
        ((1.0, 2.0), (1.0, 2.0), True),
        ((1.0,), (1.0, 2.0), False),
        ('a', 'A', False),
    ],
)
def test_answers_are_compared_to_nine_digits(one, other, equal):
    assert same(one, other) is equal
