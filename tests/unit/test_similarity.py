"""Similar submissions are found despite changed names, spacing, comments and order."""

from pathlib import Path

from hypothesis import given, settings, strategies
import pytest

from autograder.classroom.similarity import compare, finished_package, given_lines, lines_of
from autograder.commands.similar import similar_text, WARNING
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


def found(at_least=0.85, given_text='', references=None, **texts):
    answers = {student: {'talker.py': text} for student, text in texts.items()}
    given_away = frozenset(line for line, _ in lines_of('given.py', given_text))
    return compare(answers, given_away, at_least, references or {})


def shown(result, at_least=0.85):
    return similar_text(result, '01_talker', Path('/class'), at_least)


def score(one, two):
    (pair,) = found(0.0, one=one, two=two).pairs
    return pair.score


def test_another_order_makes_no_difference():
    assert score(ORIGINAL.split('Node\n', 1)[1], MOVED) == 1.0


def test_another_solution_of_the_same_exercise_is_not_listed():
    assert score(ORIGINAL, OTHER) < 0.6
    assert found(ann=ORIGINAL, bob=OTHER).pairs == []


def test_what_everybody_received_does_not_count():
    result = found(given_text=ORIGINAL, ann=ORIGINAL, bob=ORIGINAL, eve=OTHER)

    assert result.short == ['ann', 'bob']
    assert (result.compared, result.pairs) == (1, [])


def test_received_lines_do_not_make_others_alike():
    """Lines from the release do not count, so a long stub does not make answers similar."""
    assert score(ORIGINAL + OTHER, ORIGINAL) > 0.6
    result = found(0.0, given_text=ORIGINAL, ann=ORIGINAL + OTHER, bob=ORIGINAL + RENAMED)

    assert result.pairs[0].score < 0.6


def test_received_lines_are_compared_as_they_were_received():
    """A file may define a name of a received line; a line with other names was not received."""
    received = 'rclpy.spin(node)\nx = None\n'
    result = found(
        given_text=received,
        ann='node = 1\n' + 'rclpy.spin(node)\n' * 20,
        bob=''.join(f'y{number} = None\n' for number in range(20)),
    )

    assert (result.compared, result.short) == (1, ['ann'])


def test_each_copy_is_listed_once_beside_the_first():
    """Other names, spacing and comments make no difference."""
    result = found(ann=ORIGINAL, bob=RENAMED, eve=ORIGINAL, max=OTHER)

    assert result.pairs == [(1.0, 'ann', 'bob', 13), (1.0, 'ann', 'eve', 13)]
    assert result.compared == 4


def test_the_most_alike_come_first_and_too_many_are_counted(monkeypatch):
    texts = {
        f's{n}': ORIGINAL + f'        self.x{n} = {"+".join("012345"[: n + 1])}\n'
        for n in range(6)
    }
    result = found(0.5, **texts)
    scores = [pair.score for pair in result.pairs]
    assert scores == sorted(scores, reverse=True)

    monkeypatch.setattr('autograder.classroom.similarity.MOST', 4)
    fewer = found(0.5, **texts)
    assert fewer.pairs == result.pairs[:4]
    assert fewer.more == len(result.pairs) - 4
    assert f'... and {fewer.more} more pairs.' in shown(fewer)


REFERENCE = {'nodes': {'talker.py': ORIGINAL}, 'all': {'talker.py': ORIGINAL, 'b.py': OTHER}}


def test_a_copy_of_the_finished_package_is_listed():
    result = found(references=REFERENCE, ann=RENAMED, bob=OTHER)

    (pair,) = result.pairs
    assert (pair.first, pair.second) == ('ann', 'nodes')
    assert result.compared == 2


def test_a_lesson_that_asks_for_its_nodes_is_compared_with_the_package():
    layout = Layout.here()
    lessons = {name: load_lesson(layout, name) for name in ('03_topics', '07_temperature_monitor')}
    nodes, package = finished_package(layout, lessons['07_temperature_monitor']).values()

    assert set(nodes) == {'temp_publisher.py', 'temp_subscriber.py'}
    assert {'threshold.py', *nodes} < set(package)
    assert finished_package(layout, lessons['03_topics']) == {}


def test_a_name_of_ros_is_no_name_of_the_students():
    other = ORIGINAL.replace('create_publisher', 'create_subscription').replace('1.0', '2.0')

    assert score(ORIGINAL, other) < 1.0


@pytest.mark.parametrize('text', ['def broken(:\n  x', 'x = (', '\x00', '"""open', '  if x:\n y'])
def test_text_that_is_no_python_is_compared_as_words(text):
    long = '\n'.join([text, *('some words of nobody else here',) * 10])

    assert score(long, long.replace('words', 'terms')) > 0.8


@settings(deadline=None, max_examples=40)
@given(strategies.text(max_size=200), strategies.text(max_size=200))
def test_any_text_can_be_compared(one, two):
    for pair in found(0.0, one=one, two=two).pairs:
        assert 0 <= pair.score <= 1


def test_other_files_are_read_as_words():
    ((line, _),) = lines_of('msg/T.msg', '# all comment\nfloat64 value   # in C\n')

    assert line == ('float64', 'value')


def test_the_release_gives_away_its_cells_without_their_magic():
    cells = [
        {'cell_type': 'code', 'source': '%%node talker\nimport rclpy\n'},
        {'cell_type': 'code', 'source': '!ls\nx = 1'},
        {'cell_type': 'markdown', 'source': 'y = 2'},
    ]

    assert given_lines({'cells': cells}) == {('import', 'rclpy'), ('x', '=', '1')}


def test_the_list_says_that_it_is_no_proof():
    text = shown(found(ann=ORIGINAL, bob=RENAMED, eve=OTHER))

    assert WARNING in text
    assert 'proves nothing' in text
    assert 'Two submissions of this class are typically' in text
    assert 'The files are /class/STUDENT/01_talker/*.ipynb.' in text
    assert '100%   13 common lines  ann  ~  bob' in text


@pytest.mark.parametrize('texts', [{}, {'ann': ORIGINAL}, {'ann': ORIGINAL, 'bob': OTHER}])
def test_the_list_says_that_no_pair_is_similar(texts):
    assert shown(found(**texts)).endswith('No two submissions are 85% or more alike.')


def test_hostile_words_have_no_effect_on_a_terminal():
    """A notebook's file name comes from a student."""
    assert '\x1b' not in shown(found(**{'ann': ORIGINAL, 'bob/\x1b[31m.ipynb': ORIGINAL}))
