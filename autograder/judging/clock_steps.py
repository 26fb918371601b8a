"""
How finely simulated time moves for a program: its timers decide, as far as its code names them.

A timer fires at most once a clock step.  One of 0.1 s that counts to ten is a correct way to do
something once a second, and in steps of a quarter second would do it every two and a half.  So
the clock of an exam with a rhythm moves in finer steps for a program that names a shorter period.
For one whose timers are all known, and long beside a step, every second step is enough.

What cannot be read, may be short: then numbers that stand in the code are taken for periods.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
import math
import re

from autograder.judging.code_periods import FOR_EVER_S, written_periods
from autograder.judging.learners_code import trees, without_texts
from autograder.judging.own_time import may_have_a_clock
from autograder.runs.scenario import Advance, Await, Feed, Join, Mark, Offer, Scenario

FINER = (1, 2, 5, 10, 25)
"""Into how many parts a step may be divided."""
MOST_STEPS = 6100
"""Of a run [clock steps]; each takes some 3 ms, and a run has 75 s."""
SHORTEST_GUESS_S = 0.05
"""Numbers below this are taken for periods only where a timer gets them."""
COARSER = Fraction(1, 2)
_AT_ONCE = re.compile(
    r'\b((?!SingleThreadedExecutor\b)\w*Executor|async|await|\w*[tT]hread(s|ing)?'
    r'|create_rate|Rate|timer_period_ns)\b'
)


def parts_of(scenario: Scenario, files: Mapping[str, str]) -> Fraction:
    """
    Return into how many parts each clock step of a scenario is divided for a program.

    :param files: relative path to text
    :returns: 1/2 joins two steps
    """
    advances = [step for step in scenario.steps if isinstance(step, Advance)]
    kinds = {type(step) for step in scenario.steps}
    if not advances or kinds & {Feed, Join, Offer}:  # answers are asked for, whenever they come
        return Fraction(1)
    most = MOST_STEPS // sum(step.count for step in advances)
    parts = divided(files, max(step.step_s for step in advances), most)
    # Who is also asked or called is looked at as often as the exam says.
    return parts if kinds <= {Advance, Await, Mark} else max(parts, Fraction(1))


def stepped(scenario: Scenario, parts: Fraction) -> Scenario:
    """
    Return a scenario whose clock moves in parts of its steps.

    All moments at which the exam's own steps end stay what they are.

    :param parts: from :func:`parts_of`
    """
    steps = [in_parts(one, parts) if isinstance(one, Advance) else one for one in scenario.steps]
    return replace(scenario, steps=tuple(steps))


def divided(files: Mapping[str, str], step_s: float, most: int = FINER[-1]) -> Fraction:
    """
    Return into how many parts a step of an exam is divided for a program; 1/2 joins two.

    :param files: relative path to text
    :param step_s: of the exam [s]
    :param most: into so many at most
    """
    periods = written_periods(files)
    known = {period for period in periods if period is not None}
    if periods and None not in periods and _are_long(known, 2 * step_s) and not _may_pause(files):
        return COARSER
    guesses = _guesses(files) if None in periods else ()
    short = [*known, *(guess for guess in guesses if guess >= SHORTEST_GUESS_S)]
    short = [period for period in short if period < step_s]
    allowed = [parts for parts in FINER if parts <= max(most, 1)]
    enough = [parts for parts in allowed if all(_fits(one, step_s / parts) for one in short)]
    parts = min(enough, default=allowed[-1])
    # Who makes a timer anew in its callback rounds it up to a step each time.
    exact = [one for one in allowed if one >= parts and _are_whole(known, step_s / one)]
    return Fraction(min(exact, default=parts))


def _fits(period_s: float, step_s: float) -> bool:
    return step_s <= period_s * (1 + 1e-9)


def _are_whole(periods_s: Collection[float], step_s: float) -> bool:
    """Tell whether each period takes whole steps."""
    return all(abs(one / step_s - round(one / step_s)) < 1e-6 for one in periods_s)


def _are_long(periods_s: Collection[float], step_s: float) -> bool:
    """Tell whether each period takes two whole steps or more."""
    return all(_fits(one, 2 * step_s) for one in periods_s) and _are_whole(periods_s, step_s)


def _may_pause(files: Mapping[str, str]) -> bool:
    """Tell whether anything but the timers of one thread may pace what a program does."""
    texts = map(without_texts, files.values())
    return may_have_a_clock(files) or any(_AT_ONCE.search(text) for text in texts)


def in_parts(advance: Advance, parts: Fraction) -> Advance:
    """
    Return the same stretch of time in other steps; it ends at the same moment.

    :param parts: of each step, from :func:`parts_of`
    """
    if parts == 1:
        return advance
    step_s = advance.step_s / parts
    if parts < 1:
        alone = (advance.count - 1) % 2  # a step of the exam before the first pair
        first_s, count = advance.phase_s + alone * advance.step_s, (advance.count + 1) // 2
        return replace(advance, step_s=float(step_s), phase_s=first_s, seconds=count * step_s)
    before = max(math.ceil(round(advance.phase_s / step_s, 6)) - 1, 0)
    count = before + (advance.count - 1) * int(parts) + 1
    first_s = advance.phase_s - before * step_s
    return replace(advance, step_s=float(step_s), phase_s=first_s, seconds=count * step_s)


def _guesses(files: Mapping[str, str]) -> Iterator[float]:
    """
    Yield the numbers of a program, and a short one where it computes.

    What is computed from numbers that come from elsewhere may be anything.
    """
    nodes = [node for tree in trees(files) for node in ast.walk(tree)]
    if any(_computes(node) for node in nodes):
        yield SHORTEST_GUESS_S
    for node in nodes:
        number = _number(node)
        if number is not None and 0 < number < FOR_EVER_S:
            yield number


def _computes(node: ast.AST) -> bool:
    """Tell whether units are changed, or a rate is made a period: x / 1000, x * 1e-3, 1 / x."""
    if not isinstance(node, (ast.BinOp, ast.AugAssign)):
        return False
    left, right = (node.left, node.right) if isinstance(node, ast.BinOp) else (None, node.value)
    if isinstance(node.op, ast.Div):
        return _number(left) == 1 or (_number(right) or 0) >= 10
    if isinstance(node.op, ast.Mult):
        return any(0 < (_number(one) or 0) <= 0.1 for one in (left, right))
    return False


def _number(node: ast.AST | None) -> float | None:
    value = node.value if isinstance(node, ast.Constant) else None
    return value if isinstance(value, (int, float)) else None
