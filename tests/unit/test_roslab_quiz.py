"""Practice questions: their files, error messages, and the text for viewers without widgets."""

from collections import Counter
import random
import re

import jsonschema
import pytest
import yaml

from roslab import quiz as show
from roslab.errors import RoslabError
from roslab.quiz import files, find, load, Question, QuizError

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
    (tmp_path / '03_topics.yaml').write_text(GOOD)
    return tmp_path


TEXT = {'type': 'string', 'pattern': r'^(?=.*\S)[^`]*(`[^`]*`[^`]*)*$'}
OPTION = {
    'type': 'object',
    'properties': {'text': TEXT, 'why': TEXT, 'right': {'type': 'boolean'}},
    'required': ['text', 'why'],
    'additionalProperties': False,
}
QUESTION = {
    'type': 'object',
    'properties': {
        'key': {'pattern': r'^\d\d-[a-z0-9]+(-[a-z0-9]+)*$'},
        'question': TEXT,
        'options': {
            'type': 'array',
            'items': OPTION,
            'minItems': 3,
            'maxItems': 4,
            'contains': {'required': ['right'], 'properties': {'right': {'const': True}}},
            'maxContains': 1,
        },
    },
    'required': ['key', 'question', 'options'],
    'additionalProperties': False,
}


@pytest.mark.parametrize('path', files(), ids=lambda path: path.name)
def test_questions_of_the_course_are_well_formed(path):
    assert re.fullmatch(r'\d\d_[a-z0-9_]+\.yaml', path.name)
    for question in yaml.safe_load(path.read_text()):
        jsonschema.validate(question, QUESTION)
        assert question['key'].startswith(f'{path.name[:2]}-')
        texts = {one['text'].casefold().rstrip('.') for one in question['options']}
        assert len(texts) == len(question['options']), question['key']


def test_no_key_is_used_twice():
    keys = Counter(question.key for path in files() for question in load(path))

    assert [key for key, count in keys.items() if count > 1] == []


def test_no_letter_is_right_so_often_that_choosing_it_would_pay():
    """The order of the options depends on the keys: if this test fails, change some keys."""
    questions = [question for path in files() for question in load(path)]
    places = Counter([option.right for option in one.options].index(True) for one in questions)

    assert max(places.values()) <= len(questions) / 2


def test_question_is_read_whole(folder):
    question = find('03-matched', folder)

    assert question.text == 'Is `x` matched?'
    assert {option.text: option.right for option in question.options} == {
        'It is': True,
        'It is not': False,
        'Nobody knows': False,
    }
    assert all(option.why for option in question.options)


def test_order_depends_on_the_key_alone(folder):
    """All students see the same letters, even if other code has set the random seed."""
    first = find('03-matched', folder)
    random.seed(7)

    assert find('03-matched', folder) == first


def test_right_answers_are_spread_over_the_letters(folder):
    path = folder / '03_topics.yaml'
    path.write_text(''.join(GOOD.replace('03-matched', f'03-m{n}') for n in range(300)))
    places = Counter(
        [option.right for option in question.options].index(True) for question in load(path)
    )

    assert min(places[place] for place in range(3)) > 60


@pytest.mark.parametrize(
    ('old', 'new'),
    [
        ('question:', 'asked:'),
        (', why: Because.', ''),
        ('right: true', 'right: 1'),
        (', right: true', ''),
        ('why: But', 'right: true, why: But'),
        ('    - {text: Nobody knows, why: Somebody does.}\n', ''),
        ('Is `x`', 'Is `x'),
        ('key: 03-matched', 'key: 03_Matched'),
        ('why: Because.', 'why: ""'),
    ],
)
def test_mistake_of_an_author_is_found(old, new):
    assert GOOD.count(old) == 1, old
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(yaml.safe_load(GOOD.replace(old, new))[0], QUESTION)


@pytest.mark.parametrize('text', ['', 'key: x', '- 1', '- {key: x}', '- `x'])
def test_file_of_another_form_is_refused(folder, text):
    (folder / '03_topics.yaml').write_text(text)
    with pytest.raises(QuizError, match=r'03_topics\.yaml: .*test_roslab_quiz'):
        load(folder / '03_topics.yaml')


def test_unknown_key_is_answered_with_the_near_ones(folder):
    with pytest.raises(RoslabError, match=r"'03-matched'; there is no '03-macthed'"):
        find('03-macthed', folder)


def test_broken_file_of_another_lesson_does_not_matter(folder):
    (folder / '04_messages.yaml').write_text('- nonsense')

    assert isinstance(find('03-matched', folder), Question)


def test_viewer_without_widgets_gets_the_question_and_its_letters():
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
