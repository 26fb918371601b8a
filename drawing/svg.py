"""
Provide the elements of the SVG pictures, which are also described in words for screen readers.

Lines and letters take the colour of the surrounding text, and areas have a transparent tint, so
pictures are readable on light and dark pages.  Colour is never the only sign of a difference.
"""

from collections.abc import Iterable, Sequence
import hashlib
import html
import math

FONT = 'system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif'

_LEAST = 480.0  # minimum width in pixels for readable letters; a narrower page scrolls the picture

BLUE = '#1e88e5'
ORANGE = '#f57c00'
RED = '#e53935'
GREEN = '#43a047'

Table = Sequence[Sequence[object]]
"""The data of a picture: the first row names the columns."""
MAX_ROWS = 60
"""Maximum number of table rows, or of times in one cell, that a reader can still follow."""


def escape(text: object) -> str:
    """
    Return text that is safe inside an HTML element and inside an attribute.

    :param text: anything; names and messages come from untrusted programs
    """
    cleaned = ''.join(letter if letter.isprintable() else ' ' for letter in str(text))
    return html.escape(cleaned)


def picture(
    width: float,
    height: float,
    title: str,
    description: str,
    parts: Iterable[str],
    table: Table = (),
    below: str = '',
) -> str:
    """
    Return a complete picture as HTML, with its data in a table that opens below it.

    :param width: width of the drawing; it shrinks to fit a narrow page
    :param table: the data, for :func:`data_table`; empty if the page shows the data elsewhere
    :param below: HTML below the drawing, as wide as the drawing
    """
    drawn = ''.join(parts)
    # Equal pictures have equal ids, so that equal results give identical pages.
    whole = f'{title}|{description}|{drawn}'
    name = f'picture-{hashlib.sha256(whole.encode()).hexdigest()[:12]}'
    least = f'min-width: {min(width, _LEAST):.0f}px'
    below = below and f'<div style="max-width: {width:.0f}px; {least}">{below}</div>'
    return (
        # Focusable, so that users can scroll it on a narrow page without a mouse.
        f'<div role="group" aria-label="{escape(title)}" tabindex="0" '
        f'style="overflow-x: auto; color: var(--jp-content-font-color1, currentColor)">'
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" '
        f'aria-labelledby="{name}-title {name}-words" width="{width:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" '
        f'style="max-width: 100%; {least}; height: auto" '
        f'font-family="{html.escape(FONT)}" font-size="12" fill="currentColor">'
        f'<title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-words">{escape(description)}</desc>'
        f'{drawn}</svg>{below}</div>{data_table(title, table) if table else ""}'
    )


def data_table(title: str, table: Table) -> str:
    """Return the data of a picture as HTML: a heading that opens a table when clicked."""
    head, *rows = ([escape(cell) for cell in row] for row in table)
    cell = 'style="text-align: left; padding: 2px 12px 2px 0"'
    names = ''.join(f'<th scope="col" {cell}>{name}</th>' for name in head)
    body = ''.join(f'<tr>{"".join(f"<td {cell}>{one}</td>" for one in row)}</tr>' for row in rows)
    return (
        '<details style="color: var(--jp-content-font-color1, currentColor)">'
        f'<summary>Data of this picture</summary><div role="group" tabindex="0" '
        f'aria-label="Data: {escape(title)}" style="overflow-x: auto">'
        f'<table style="border-collapse: collapse; margin: 0"><thead><tr>{names}</tr></thead>'
        f'<tbody>{body}</tbody></table></div></details>'
    )


def listed(times: Sequence[float], most: int = MAX_ROWS) -> str:
    """Return times in one line [s]; a long list shows only the first ones and the last."""
    head = times if len(times) <= most else times[: most - 2]
    words = ' '.join(f'{time:.2f}' for time in head)
    return words if len(times) <= most else f'{words} ... {times[-1]:.2f}'


def text(
    x: float,
    y: float,
    words: str,
    *,
    anchor: str = 'start',
    size: float = 12,
    bold: bool = False,
    faint: bool = False,
    italic: bool = False,
) -> str:
    """
    Return one line of text.

    :param anchor: which point of the line is at x: 'start', 'middle' or 'end'
    :param faint: use a weaker colour for less important text
    """
    style = f' font-size="{size:g}"' if size != 12 else ''
    style += ' font-weight="600"' * bold + ' font-style="italic"' * italic
    style += ' fill-opacity=".75"' * faint
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{style}>{escape(words)}</text>'


def line(
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    *,
    colour: str = 'currentColor',
    width: float = 1,
    dashed: bool = False,
    faint: bool = False,
) -> str:
    """Return a straight line."""
    dashes = ' stroke-dasharray="6 4"' if dashed else ''
    opacity = ' stroke-opacity=".25"' if faint else ''
    return (
        f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" '
        f'stroke-width="{width:g}"{dashes}{opacity}/>'
    )


def box(
    x: float, y: float, width: float, height: float, *, colour: str, rounded: float = 0
) -> str:
    """Return a rectangle tinted with a colour."""
    return (
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" '
        f'rx="{rounded:g}" fill="{colour}" fill-opacity=".16" stroke="{colour}" '
        'stroke-width="1.5"/>'
    )


_SHAPES = {
    'circle': 'M{x} {t}a{r} {r} 0 1 0 .01 0z',
    'triangle': 'M{x} {t}L{e} {b}L{w} {b}z',
    'diamond': 'M{x} {t}L{e} {y}L{x} {b}L{w} {y}z',
    'square': 'M{w} {t}H{e}V{b}H{w}z',
    'cross': 'M{w} {t}L{e} {b}M{e} {t}L{w} {b}',
    'plus': 'M{x} {t}V{b}M{w} {y}H{e}',
}


def shape(kind: str, x: float, y: float, radius: float, colour: str) -> str:
    """Return a small symbol: circle, triangle, diamond, square, cross or plus."""
    places = {'x': x, 'y': y, 't': y - radius, 'b': y + radius, 'w': x - radius, 'e': x + radius}
    texts = {name: f'{place:.1f}' for name, place in places.items()}
    path = _SHAPES[kind].format(**texts, r=f'{radius:g}')
    return f'<path d="{path}" fill="{colour}" stroke="{colour}" stroke-width="1.6"/>'


def text_width(words: str, size: float = 12) -> float:
    """Estimate the width of a string, with a margin because fonts differ between machines."""
    wide = sum(
        1.45 if letter in 'mwMW@' else 0.62 if letter in 'iljft/.:,|() ' else 1.0
        for letter in words
    )
    return wide * size * 0.6


def ticks(low: float, high: float, most: int = 8) -> list[float]:
    """Return round numbers between two limits, for an axis."""
    raw = max(high - low, 1e-9) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= raw * 0.999)
    first, last = math.ceil(low / step), math.floor(high / step + 1e-6)
    return [round(number * step, 10) for number in range(first, last + 1)]
