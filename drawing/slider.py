"""A slider through the moments of a picture, for mouse and keyboard; it needs no kernel."""

from collections.abc import Sequence
import json

from drawing import svg

MAX_MOMENTS = 200
"""Maximum number of moments; longer lists are thinned out evenly."""
_HALF_A_THUMB_PX = 8
"""The thumb stays inside the slider, so a slider begins and ends this much beyond its axis."""
# All states are in the page, so the slider also works without a kernel.  A mouse selects the
# moment that is nearest on the axis; a key moves by `by` moments.
_MOVE = (
    'const all = JSON.parse(this.dataset.moments), by = this.by;'
    'const far = i => Math.abs(all[i][0] - this.value);'
    'const near = all.reduce((best, _, i) => far(i) > far(best) ? best : i, 0);'
    'const at = by ? Math.max(0, Math.min(all.length - 1, Number(this.dataset.at) + by)) : near;'
    'const [x, words] = all[at];'
    'this.by = 0; this.dataset.at = at; this.value = x;'
    'const whole = this.closest("[role=group]");'
    'whole.querySelector("[data-cursor]").setAttribute("transform", `translate(${x})`);'
    'whole.querySelector("output").textContent = words;'
    'this.setAttribute("aria-valuetext", words)'
)
_KEY = (
    'this.by = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1,'
    ' PageUp: 10, PageDown: -10}[event.key];'
    'if (this.by) { event.preventDefault(); this.dispatchEvent(new Event("input")) }'
)


def cursor(x: float, top: float, bottom: float) -> str:
    """Return the line that a slider moves, at its initial position x."""
    drawn = svg.line(0, top, 0, bottom, colour=svg.ORANGE, width=2)
    return f'<g data-cursor="" transform="translate({x:.1f})">{drawn}</g>'


def slider(
    title: str, moments: Sequence[tuple[float, str]], axis: tuple[float, float], width: float
) -> str:
    """
    Return a slider, set to the last moment, to put below a picture.

    :param title: title of the picture, which has a :func:`cursor` at the last moment
    :param moments: the position of the cursor and a description of the state, in order
    :param axis: positions of both ends of the picture's axis, which the slider shares
    :param width: width of the picture, in the same unit
    """
    step = max(1, -(-len(moments) // MAX_MOMENTS))
    shown = [(round(x, 1), words) for x, words in reversed(moments[::-1][::step])]
    (x, words), (left, right) = shown[-1], axis
    return (
        # JupyterLab would otherwise use the arrow keys to move between cells.
        '<input type="range" data-lm-suppress-shortcuts="true" style="display: block; '
        f'box-sizing: border-box; margin: 0 0 0 calc({left / width:.2%} - {_HALF_A_THUMB_PX}px); '
        f'width: calc({(right - left) / width:.2%} + {2 * _HALF_A_THUMB_PX}px)" '
        f'min="{left:.1f}" max="{right:.1f}" step="any" value="{x}" data-at="{len(shown) - 1}" '
        f'aria-label="Moment: {svg.escape(title)}" aria-valuetext="{svg.escape(words)}" '
        f'data-moments="{svg.escape(json.dumps(shown))}" '
        f'oninput="{svg.escape(_MOVE)}" onkeydown="{svg.escape(_KEY)}">'
        f'<output style="display: block">{svg.escape(words)}</output>'
    )
