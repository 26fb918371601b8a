"""Hidden exam of lesson 10: secret speeds and a secret limit, in a secret namespace."""

from autograder.exam.inputs import generator
from autograder.exam.steps import BURST
from exams.visible.limiter import build

_draw = generator('limiter', 'speeds')


def _between(low: float, high: float) -> float:
    return round(_draw.uniform(low, high), 3)


def _mixed(*speeds: float) -> list[float]:
    return _draw.sample(speeds, len(speeds))


_most = _between(0.1, 0.3)
_before = _mixed(
    *(_between(0.05, 0.45), _between(0.6, 0.9), _between(1.1, 4.0)),
    *(_between(-0.45, -0.05), _between(-0.9, -0.6), _between(-4.0, -1.1), 0.0),
)
exam = build(
    f'/{"".join(_draw.choices("bdghjklmnprtvwz", k=6))}',
    # A speed that equals the previous one or an earlier one is an ordinary speed.
    [*_before, _before[-1], _before[0]],
    _most,
    [
        *_mixed(_between(0.32, 0.48), _between(-0.48, -0.32), _between(0.001, 0.009), -_most),
        *_mixed(_between(0.6, 2.0), _between(-2.0, -0.6), _between(-0.09, -0.01)),
        *(_between(-2.0, 2.0) for _ in range(BURST - 3)),
    ],
    burst=BURST,
)
