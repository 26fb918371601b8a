"""Similar submissions are found despite changed names, spacing, comments and order."""

from dataclasses import asdict
import json

from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.similarity import (
    compare,
    finished_package,
    given_lines,
    lines_of,
    WARNING,
)
from autograder.commands.similar import similar_text
from autograder.grading.pipeline import load_lesson
from autograder.layout import Layout

ORIGINAL = '''
import rclpy
from rclpy.node import Node


class Talker(Node):
    """Says something every second."""

    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(1.0, self.on_timer)

    def on_timer(self):
        message = String()
        message.data = f'hello {self.count}'
        self.publisher.publish(message)
        self.count += 1
'''
RENAMED = '''
import rclpy   # ROS
from rclpy.node import Node

class Sprecher( Node ):
    def __init__( self ):
        # my own idea
        super().__init__( "talker" )
        self.zahl = 0
        self.kanal = self.create_publisher( String, "chatter", 10 )
        self.uhr = self.create_timer( 1.0,
                                      self.jede_sekunde )
    def jede_sekunde( self ):
        """Another docstring."""
        nachricht = String()
        nachricht.data = f'hello {self.zahl}'
        self.kanal.publish( nachricht )
        self.zahl += 1
'''
MOVED = """
class Talker(Node):
    def on_timer(self):
        message = String()
        message.data = f'hello {self.count}'
        self.publisher.publish(message)
        self.count += 1

    def __init__(self):
        super().__init__('talker')
        self.timer = self.create_timer(1.0, self.on_timer)
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.count = 0
"""
OTHER = """
def main():
    rclpy.init()
    node = rclpy.create_node('talker')
    channel = node.create_publisher(String, 'chatter', 10)
    numbers = iter(range(10_000))
    node.create_timer(1.0, lambda: channel.publish(String(data=f'hello {next(numbers)}')))
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()
"""


def found(at_least=0.85, given_text='', **texts):
    answers = {student: {'talker.py': text} for student, text in texts.items()}
    given_away = frozenset(line.raw for line in lines_of('given.py', given_text))
    return compare('01_talker', answers, given_away, at_least)


def score(one, two):
    (pair,) = found(0.0, one=one, two=two).pairs
    return pair.score


def test_other_names_spacing_and_comments_make_no_difference():
    """The normalised code is equal, and the share of renamed lines is reported."""
    (pair,) = found(ann=ORIGINAL, bob=RENAMED).pairs

    assert (pair.first, pair.second, pair.score) == (('ann', 'bob'), (), 1.0)
    assert pair.renamed > 0.5


def test_another_order_makes_little_difference():
    """Moved methods and lines hardly change the score."""
    assert score(ORIGINAL.split('Node\n', 1)[1], MOVED) > 0.9


def test_another_solution_of_the_same_exercise_is_not_listed():
    """All solutions of an exercise share some words."""
    assert score(ORIGINAL, OTHER) < 0.6
    assert found(ann=ORIGINAL, bob=OTHER).pairs == ()


def test_what_everybody_received_does_not_count():
    """Two unchanged releases are not compared, because they contain no student's code."""
    result = found(given_text=ORIGINAL, ann=ORIGINAL, bob=ORIGINAL, eve=OTHER)

    assert result.short == ('ann', 'bob')
    assert (result.compared, result.pairs) == (1, ())


def test_received_lines_do_not_make_others_alike():
    """Lines from the release do not count, so a long stub does not make answers similar."""
    assert score(ORIGINAL + OTHER, ORIGINAL) > 0.6
    result = found(0.0, given_text=ORIGINAL, ann=ORIGINAL + OTHER, bob=ORIGINAL + RENAMED)

    assert result.pairs[0].score < 0.6


def test_the_common_part_is_shown_as_each_wrote_it():
    """The common lines are shown with their line numbers."""
    (pair,) = found(ann=ORIGINAL, bob=RENAMED).pairs
    (part,) = pair.common

    assert 'self.count += 1' in part.first
    assert 'self.zahl += 1' in part.second
    assert ORIGINAL.splitlines()[part.first_line - 1].strip() == part.first[0]


def test_three_copies_are_one_entry():
    """Three equal submissions give one entry, not three pairs."""
    result = found(ann=ORIGINAL, bob=RENAMED, eve=ORIGINAL, max=OTHER)

    assert [pair.first for pair in result.pairs] == [('ann', 'bob', 'eve')]
    assert result.compared == 4


def test_the_most_alike_come_first_and_too_many_are_counted(monkeypatch):
    """The list is limited, so that it stays short enough to read."""
    texts = {
        f's{n}': ORIGINAL + f'        self.x{n} = {"+".join("12345"[:n])}\n' for n in range(6)
    }
    result = found(0.5, **{name: text.replace(' = \n', ' = 0\n') for name, text in texts.items()})
    scores = [pair.score for pair in result.pairs]
    assert scores == sorted(scores, reverse=True)

    monkeypatch.setattr('autograder.classroom.similarity.MOST', 4)
    fewer = found(0.5, **{name: text.replace(' = \n', ' = 0\n') for name, text in texts.items()})
    assert fewer.pairs == result.pairs[:4]
    assert fewer.more == len(result.pairs) - 4


REFERENCE = {'nodes': {'talker.py': ORIGINAL}, 'all': {'talker.py': ORIGINAL, 'b.py': OTHER}}


def test_a_copy_of_the_finished_package_is_listed():
    """The package is not a student, and its two forms are not compared with each other."""
    texts = {'ann': {'talker.py': RENAMED}, 'bob': {'talker.py': OTHER}}
    result = compare('01_talker', texts, frozenset(), 0.85, REFERENCE)

    (pair,) = result.pairs
    assert {*pair.first, *pair.second} == {'ann', 'nodes'}
    assert result.compared == 2


def test_a_lesson_that_asks_for_its_nodes_is_compared_with_the_package():
    """Other lessons are not compared with a package."""
    layout = Layout.here()
    lessons = {name: load_lesson(layout, name) for name in ('03_topics', '07_temperature_monitor')}
    nodes, package = finished_package(layout, lessons['07_temperature_monitor']).values()

    assert set(nodes) == {'temp_publisher.py', 'temp_subscriber.py'}
    assert {'threshold.py', *nodes} < set(package)
    assert finished_package(layout, lessons['03_topics']) == {}


def test_a_name_of_ros_is_no_name_of_the_students():
    """create_publisher and create_subscription remain different tokens."""
    other = ORIGINAL.replace('create_publisher', 'create_subscription').replace('1.0', '2.0')

    assert score(ORIGINAL, other) < 1.0


@pytest.mark.parametrize('text', ['def broken(:\n  x', 'x = (', '\x00', '"""open', '  if x:\n y'])
def test_text_that_is_no_python_is_compared_as_words(text):
    """Text that cannot be parsed is compared word by word."""
    long = '\n'.join([text, *('some words of nobody else here',) * 10])

    assert score(long, long.replace('words', 'terms')) > 0.8


@settings(deadline=None, max_examples=40)
@given(strategies.text(max_size=200), strategies.text(max_size=200))
def test_any_text_can_be_compared(one, two):
    """No string causes an error, and every score is between 0 and 1."""
    for pair in found(0.0, one=one, two=two).pairs:
        assert 0 <= pair.score <= 1


def test_other_files_are_read_as_words():
    """Comments and spacing in other files are ignored."""
    (line,) = lines_of('msg/T.msg', '# all comment\nfloat64 value   # in C\n')

    assert (line.number, line.raw) == (2, ('float64', 'value'))


def test_the_release_gives_away_its_cells_without_their_magic():
    """Lines with magics or shell commands are not code."""
    cells = [
        {'cell_type': 'code', 'source': '%%node talker\nimport rclpy\n'},
        {'cell_type': 'code', 'source': '!ls\nx = 1'},
        {'cell_type': 'markdown', 'source': 'y = 2'},
    ]

    assert given_lines({'cells': cells}) == {('import', 'rclpy'), ('x', '=', '1')}


def test_the_list_says_that_it_is_no_proof():
    """The terminal and JSON also show how similar two submissions typically are."""
    result = found(0.0, ann=ORIGINAL, bob=RENAMED, eve=OTHER)

    assert WARNING in similar_text(result)
    assert 'proves nothing' in similar_text(result)
    assert 'Two submissions of this class are typically' in similar_text(result)
    assert json.loads(json.dumps(asdict(result)))['warning'] == WARNING


def test_hostile_words_have_no_effect_on_a_terminal():
    """Control characters in a student's text are removed."""
    text = '\n'.join(f'x{n} = "\x1b[31m{n}" + some(words)' for n in range(20))

    assert '\x1b' not in similar_text(found(ann=text, bob=text))
