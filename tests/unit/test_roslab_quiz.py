"""Practice questions: their files, their errors, and what a viewer without widgets shows."""

from collections import Counter
import random

import pytest

from roslab import quiz as show
from roslab.errors import RoslabError
from roslab.quiz import find, load, problems, Question, QuizError

GOOD = """\
- key: 03-matched
  question: Is `x` matched?
  options:
    - {text: It is, right: true, why: Because.}
    - {text: It is not, why: But it is.}
    - {text: Nobody knows, why: Somebody does.}
"""


@pytest.fixture
def folder(tmp_path):
    """Return a folder with one file of one question."""
    (tmp_path / '03_topics.yaml').write_text(GOOD)
    return tmp_path


def changed(folder, old, new):
    """Write the good file with one change, and return it."""
    assert GOOD.count(old) == 1, old
    path = folder / '03_topics.yaml'
    path.write_text(GOOD.replace(old, new))
    return path


def test_all_questions_of_the_course_are_well_formed():
    """Unique keys of the right lesson, one right option, an explanation for each."""
    assert problems() == []


def test_question_is_read_whole(folder):
    """Nothing is lost but the order of the options."""
    question = find('03-matched', folder)

    assert question.text == 'Is `x` matched?'
    assert {option.text: option.right for option in question.options} == {
        'It is': True,
        'It is not': False,
        'Nobody knows': False,
    }
    assert all(option.why for option in question.options)


def test_order_depends_on_the_key_alone(folder):
    """Two readers see the same letters, whatever else has drawn random numbers."""
    first = find('03-matched', folder)
    random.seed(7)

    assert find('03-matched', folder) == first


def test_right_answers_are_spread_over_the_letters(folder):
    """Authors who always write the right one first give nothing away."""
    path = folder / '03_topics.yaml'
    path.write_text(''.join(GOOD.replace('03-matched', f'03-m{n}') for n in range(300)))
    places = Counter(
        [option.right for option in question.options].index(True) for question in load(path)
    )

    assert min(places[place] for place in range(3)) > 60
    assert problems(folder) == []


@pytest.mark.parametrize(
    ('old', 'new', 'said'),
    [
        ('- key: 03-matched\n  question', '- question', 'question 1: key is missing'),
        ('question:', 'asked:', 'question is missing and asked is not known here'),
        ('key: 03-matched', 'key: 03_Matched', 'as in 03-matched'),
        (', why: Because.', '', 'option 1: why is missing'),
        ('why: Because.', 'why: ""', 'expected why to be a string'),
        ('It is, ', 'true, ', 'expected text to be a string, in quotes if necessary: True'),
        ('right: true', 'right: 1', 'expected right to be true or false, got 1'),
        (', right: true', '', 'one option with "right: true", got 0'),
        ('why: But', 'right: true, why: But', 'one option with "right: true", got 2'),
        ('Nobody knows', 'it IS.', 'two options are the same'),
        ('    - {text: Nobody knows, why: Somebody does.}\n', '', '3 or 4 options, got 2'),
        ('Is `x`', 'Is `x', 'an unmatched backtick'),
        ('Is `x` matched?', '`x` matched?', 'begin with a backtick'),
    ],
)
def test_mistake_of_an_author_is_named_with_its_place(folder, old, new, said):
    """The file, the question, what was expected."""
    path = changed(folder, old, new)
    with pytest.raises(QuizError) as caught:
        load(path)

    assert said in str(caught.value)
    assert str(caught.value).startswith('03_topics.yaml')
    assert problems(folder) == [str(caught.value)]


@pytest.mark.parametrize('text', ['', 'key: x', '[]', '- 1'])
def test_file_of_another_shape_is_refused(folder, text):
    """A list of questions is expected."""
    (folder / '03_topics.yaml').write_text(text)
    with pytest.raises(QuizError, match='expected'):
        load(folder / '03_topics.yaml')


def test_key_of_another_lesson_or_used_twice_is_found(folder):
    """The number tells where a question is asked."""
    (folder / '04_messages.yaml').write_text(GOOD)

    assert problems(folder) == [
        '04_messages.yaml: the key 03-matched does not begin with 04-.',
        'The key 03-matched is used more than once.',
    ]


def test_unknown_key_is_answered_with_the_near_ones(folder):
    """A typing mistake costs one look."""
    with pytest.raises(RoslabError, match=r"'03-matched'; there is no '03-macthed'"):
        find('03-macthed', folder)


def test_broken_file_of_another_lesson_does_not_matter(folder):
    """Each lesson reads its own."""
    (folder / '04_messages.yaml').write_text('- nonsense')

    assert isinstance(find('03-matched', folder), Question)


def test_viewer_without_widgets_gets_the_question_and_its_letters():
    """A notebook keeps this text; which option is right is not in it."""
    question = find('07-threshold')
    bundle = show('07-threshold')._repr_mimebundle_()
    data = bundle[0] if isinstance(bundle, tuple) else bundle
    lines = data['text/plain'].splitlines()

    assert 'application/vnd.jupyter.widget-view+json' in data
    assert data['text/html'].count('<details>') >= 3
    assert data['text/html'].count('<strong>Right.</strong>') == 1
    assert ' '.join(lines).startswith(question.text)
    assert lines[-4:] == [
        f'  {letter}) {option.text}' for letter, option in zip('abcd', question.options)
    ]
    assert not any(option.why in data['text/plain'] for option in question.options)
