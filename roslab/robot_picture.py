"""Draw a robot in its room, with its track and commands, as a picture and as text."""

from itertools import groupby
import math

from drawing import svg
from roslab.output import counted
from roslab.robot_track import (
    BOTTOM_M,
    COMMAND,
    DEADLINE,
    Happened,
    LEFT_M,
    NOT_FINITE,
    RADIUS_M,
    RIGHT_M,
    TOP_M,
    Track,
    WALL,
)

_PIXELS = 110.0  # per metre
_LEFT, _TOP, _BOTTOM = 40.0, 34.0, 40.0
_WIDTH = _LEFT + (RIGHT_M - LEFT_M) * _PIXELS + 16.0
_HEIGHT = _TOP + (TOP_M - BOTTOM_M) * _PIXELS + _BOTTOM
_MOST_POINTS = 600
_MOST_LISTED = 10
_SIGNS = {
    COMMAND: ('circle', svg.BLUE),
    'stop command': ('square', svg.GREEN),
    DEADLINE: ('diamond', svg.ORANGE),
    WALL: ('cross', svg.RED),
    NOT_FINITE: ('triangle', svg.RED),
}
_HEAD = ('seconds', 'what', 'times', 'speed [m/s]', 'turn [rad/s]', 'x [m]', 'y [m]')


def track_words(track: Track, refused: str = '') -> str:
    """Describe the picture; ``refused`` is the QoS policy of a refused publisher, or empty."""
    words = f'The robot is at {_place(track)}, after {track.time_s:.1f} s, and '
    if track.moving:
        words += f'drives {track.speed:g} m/s, turning {track.turn:g} rad/s'
    else:
        words += 'stands still'
    if track.at_wall:
        words += ' at a wall'
    words += f'. {counted(track.arrived, "command")} arrived'
    if track.arrived:
        words += f', the last at {track.arrived[-1].time_s:.2f} s'
    misses = [one for one in track.happened if one.what == DEADLINE]
    if misses:
        words += f'; a missed deadline stopped it {counted(misses, "time")}'
    return words + (f'; a publisher was refused: {refused}.' if refused else '.')


def track_text(track: Track, refused: str = '') -> str:
    """Return the picture as text: a one-sentence summary and the latest events."""
    lines = [track_words(track, refused)]
    for seconds, what, times, speed, turn, x, y in _rows(track)[-_MOST_LISTED:]:
        more = f' ({times} times)' if times > 1 else ''
        lines.append(f'  {seconds:>7} s  at x {x}, y {y}: {what}, {speed} m/s, {turn} rad/s{more}')
    return '\n'.join(lines)


def track_html(track: Track, refused: str = '') -> str:
    """Return the picture with its data in a table."""
    parts = [*_room(), *_legend(track, refused)]
    path = track.path
    points = [*path[:: max(1, math.ceil(len(path) / _MOST_POINTS))], track.pose]
    drawn = ' '.join(f'{_x(one.x):.1f},{_y(one.y):.1f}' for one in points)
    parts.append(f'<polyline points="{drawn}" fill="none" stroke="{svg.BLUE}" stroke-width="2"/>')
    for sign, first, _ in _groups(track):
        kind, colour = _SIGNS[sign]
        parts.append(svg.shape(kind, _x(first.pose.x), _y(first.pose.y), 5, colour))
    parts.append(_body(track))
    title, words = f'Robot at {_place(track)}', track_words(track, refused)
    return svg.picture(_WIDTH, _HEIGHT, title, words, parts, [_HEAD, *_rows(track)])


def _groups(track: Track) -> list[tuple[str, Happened, int]]:
    """Return the newest groups of equal consecutive events: symbol, first event and count."""
    found = []
    for (sign, *_), group in groupby(
        track.happened, key=lambda one: (_sign(one), one.speed, one.turn)
    ):
        first, *others = group
        found.append((sign, first, 1 + len(others)))
    return found[-svg.MAX_ROWS :]


def _rows(track: Track) -> list[tuple[str, str, int, str, str, str, str]]:
    rows = []
    for sign, one, count in _groups(track):
        x, y = _number(one.pose.x), _number(one.pose.y)
        rows.append((f'{one.time_s:.2f}', sign, count, f'{one.speed:g}', f'{one.turn:g}', x, y))
    return rows


def _sign(one: Happened) -> str:
    stops = one.what == COMMAND and not (one.speed or one.turn)
    return 'stop command' if stops else one.what


def _place(track: Track) -> str:
    return f'x {_number(track.pose.x)} m, y {_number(track.pose.y)} m'


def _number(metres: float) -> str:
    return f'{round(metres, 2) + 0.0:.2f}'  # never -0.00


def _x(metres: float) -> float:
    return _LEFT + (metres - LEFT_M) * _PIXELS


def _y(metres: float) -> float:
    return _TOP + (TOP_M - metres) * _PIXELS


def _room() -> list[str]:
    """Return the walls and a one-metre grid."""
    left, right, top, bottom = _x(LEFT_M), _x(RIGHT_M), _y(TOP_M), _y(BOTTOM_M)
    parts = [
        f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
        f'height="{bottom - top:.1f}" fill="none" stroke="currentColor" stroke-width="3"/>',
        svg.text(right, _HEIGHT - 6, 'metres', anchor='end', size=11, faint=True),
    ]
    for x in range(math.ceil(LEFT_M), math.floor(RIGHT_M) + 1):
        parts.append(svg.line(_x(x), top, _x(x), bottom, faint=True))
        parts.append(svg.text(_x(x), bottom + 17, f'{x}', anchor='middle', size=11))
    for y in range(math.ceil(BOTTOM_M), math.floor(TOP_M) + 1):
        parts.append(svg.line(left, _y(y), right, _y(y), faint=True))
        parts.append(svg.text(left - 8, _y(y) + 4, f'{y}', anchor='end', size=11))
    return parts


def _legend(track: Track, refused: str) -> list[str]:
    """Return the number of commands, and the meaning of each symbol in the picture."""
    there = [name for name in _SIGNS if any(_sign(one) == name for one in track.happened)]
    signs = ', '.join(f'{_SIGNS[name][0]}: {name}' for name in there)
    first = f'{counted(track.arrived, "command")} arrived'
    if refused and not track.arrived:
        first = f'refused: {refused}'
    return [
        svg.text(_LEFT, 20, first, bold=True, size=13),
        svg.text(_x(RIGHT_M), 20, signs, anchor='end', size=11),
    ]


def _body(track: Track) -> str:
    """Return the robot: a circle with a line towards its front."""
    x, y, radius = _x(track.pose.x), _y(track.pose.y), RADIUS_M * _PIXELS
    colour = svg.RED if track.at_wall else svg.ORANGE
    ahead_x = x + radius * math.cos(track.pose.heading)
    ahead_y = y - radius * math.sin(track.pose.heading)
    circle = (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{colour}" fill-opacity=".35" '
        f'stroke="{colour}" stroke-width="2"/>'
    )
    return circle + svg.line(x, y, ahead_x, ahead_y, colour=colour, width=3)
