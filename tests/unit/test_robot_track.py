"""The track of a robot after some commands, and its picture."""

import math
import re
from xml.etree import ElementTree

import pytest

from roslab.robot_picture import track_html, track_text, track_words
from roslab.robot_track import COMMAND, DEADLINE, moved, NOT_FINITE, Pose, Track, WALL


def driven(*commands: tuple[float, float, float], until_s: float) -> Track:
    """Return the track after commands, each with a time, a speed and a turn."""
    track = Track()
    for command in commands:
        track.obey(*command)
    track.advance(until_s)
    return track


def test_robot_drives_as_the_last_command_says_until_another_arrives():
    track = driven((1.0, 0.5, 0.0), (3.0, 0.0, 0.0), until_s=9.0)

    assert track.pose == pytest.approx((1.0, 0.0, 0.0))
    assert not track.moving
    assert track.time_s == 9.0


def test_robot_drives_an_exact_arc():
    track = driven((0.0, 0.5, 1.0), until_s=math.pi)

    assert track.pose == pytest.approx((0.0, 1.0, math.pi))
    assert moved(Pose(0.0, 0.0, 0.0), 0.5, 1.0, math.pi) == pytest.approx(track.pose)


def test_track_is_the_same_however_often_it_is_asked():
    """Drawing the picture five times a second does not change the track."""
    once, often = driven((0.0, 0.4, 0.3), until_s=3.0), driven((0.0, 0.4, 0.3), until_s=0.0)
    for hundredth in range(301):
        often.advance(hundredth / 100)

    assert often.pose == pytest.approx(once.pose)
    often.advance(1.0)
    assert often.time_s == 3.0


def test_wall_holds_the_robot_until_it_turns_away():
    held = driven((0.0, 1.0, 0.0), (6.0, 1.0, 0.0), (6.5, 1.0, 0.0), until_s=8.0)

    assert held.at_wall
    assert held.pose.x == pytest.approx(4.85, abs=0.021)
    assert [one.what for one in held.happened] == [COMMAND, WALL, COMMAND, COMMAND]
    held.obey(8.0, -1.0, 0.0)
    held.advance(9.0)
    assert not held.at_wall
    assert held.pose.x == pytest.approx(3.85, abs=0.021)


def test_command_that_is_not_finite_stops_the_robot():
    """A robot must not keep its speed after an invalid command."""
    track = driven((0.0, 0.5, 0.0), (1.0, math.nan, 0.0), until_s=5.0)

    assert track.pose.x == pytest.approx(0.5)
    assert [one.what for one in track.arrived] == [COMMAND, NOT_FINITE]


def test_picture_says_the_same_in_words_signs_and_table():
    track = driven((0.0, 0.5, 0.0), (0.1, 0.5, 0.0), until_s=0.1)
    track.obey(1.0, 0.0, 0.0, DEADLINE)
    track.obey(2.0, 0.0, 0.0)
    page, words = track_html(track), track_words(track)
    svg = ElementTree.fromstring(re.search(r'<svg.*</svg>', page, re.DOTALL)[0])
    rows = re.findall(r'<tr>(.*?)</tr>', page.partition('<tbody>')[2])

    assert words == (
        'The robot is at x 0.50 m, y 0.00 m, after 2.0 s, and stands still. 3 commands arrived, '
        'the last at 2.00 s; a missed deadline stopped it 1 time.'
    )
    assert svg.find('{http://www.w3.org/2000/svg}desc').text == words
    assert [re.findall('>([^<]*)</td>', row)[:3] for row in rows] == [
        ['0.00', 'command', '2'],
        ['1.00', DEADLINE, '1'],
        ['2.00', 'stop command', '1'],
    ]
    assert 'circle: command, square: stop command, diamond: deadline missed' in page
    assert track_text(track).startswith(words)


def test_picture_of_a_long_drive_stays_small():
    track = Track()
    for tenth in range(36_000):
        track.obey(tenth / 10, 0.3, 0.4 if tenth % 50 else -0.4)

    assert len(track_html(track)) < 60_000


def test_refused_publisher_is_named():
    page = track_html(driven(until_s=1.0), refused='RELIABILITY')

    assert 'a publisher was refused: RELIABILITY' in page
    assert 'refused: RELIABILITY</text>' in page
