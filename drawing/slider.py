"""A slider through the moments of a picture, for mouse and keyboard, without a kernel."""

from __future__ import annotations

from collections.abc import Sequence
import json

from drawing import svg

MAX_MOMENTS = 200
"""Moments of a slider; of more, as many are chosen at equal distances."""
# The whole state of a step is in the page, so it also works in a page without a kernel.
_MOVE = (
    'const [x, words] = JSON.parse(this.dataset.moments)[this.value];'
    'const all = this.closest("[data-slider]");'
    'all.querySelector("[data-cursor]").setAttribute("transform", `translate(${x})`);'
    'all.querySelector("output").textContent = words;'
    'this.setAttribute("aria-valuetext", words)'
)


def cursor(x: float, top: float, bottom: float) -> str:
    """Return the line that a slider moves; it begins at x."""
    drawn = svg.line(0, top, 0, bottom, colour=svg.ORANGE, width=2)
    return f'<g data-cursor="" transform="translate({x:.1f})">{drawn}</g>'


def with_slider(picture: str, title: str, moments: Sequence[tuple[float, str]]) -> str:
    """
    Return a picture with a slider below it, which begins at the last moment.

    :param picture: HTML, with a :func:`cursor` at the place of the last moment
    :param title: what it is a picture of
    :param moments: in their order: the place of the cursor, and the state in words
    """
    step = max(1, -(-len(moments) // MAX_MOMENTS))
    shown = [(round(x, 1), words) for x, words in reversed(moments[::-1][::step])]
    last, end = svg.escape(shown[-1][1]), len(shown) - 1
    return (
        f'<div data-slider="">{picture}'
        # JupyterLab would otherwise take the arrow keys to move between cells.
        '<input type="range" data-lm-suppress-shortcuts="true" style="width: 100%; margin: 0" '
        f'min="0" max="{end}" value="{end}" aria-label="Moment: {svg.escape(title)}" '
        f'aria-valuetext="{last}" data-moments="{svg.escape(json.dumps(shown))}" '
        f'oninput="{svg.escape(_MOVE)}">'
        '<output style="display: block; color: var(--jp-content-font-color1, currentColor)">'
        f'{last}</output></div>'
    )
