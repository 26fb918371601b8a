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
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
import math
import re

from autograder.judging.learners_code import (
    last_name,
    RATES,
    trees,
    without_texts,
    written_periods,
)
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
    if _are_long(files, 2 * step_s):
        return COARSER
    shortest_s = min(_short_periods(files, step_s), default=step_s)
    allowed = [parts for parts in FINER if parts <= max(most, 1)]
    enough = [parts for parts in allowed if step_s / parts <= shortest_s * (1 + 1e-9)]
    return Fraction(min(enough, default=allowed[-1]))


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


def _are_long(files: Mapping[str, str], least_s: float) -> bool:
    """
    Tell whether timers pace all that a program does, and each takes so many steps exactly.

    :param least_s: two steps of the exam [s]; a timer has two of those at least
    """
    periods = written_periods(files)
    if not periods or None in periods or may_have_a_clock(files):
        return False
    if any(_AT_ONCE.search(without_texts(text)) for text in files.values()):
        return False
    known = [period for period in periods if period is not None]
    return all(
        period >= 2 * least_s and abs(period / least_s - round(period / least_s)) < 1e-6
        for period in known
    )


def _short_periods(files: Mapping[str, str], step_s: float) -> Iterator[float]:
    """Yield the periods below a step that a program has, or may have where one is not readable."""
    periods = written_periods(files)
    yield from (period for period in periods if period is not None and 0 < period < step_s)
    if None in periods:
        for guess in _guesses(files):
            if SHORTEST_GUESS_S <= guess < step_s:
                yield guess


def _guesses(files: Mapping[str, str]) -> Iterator[float]:
    """Yield the numbers of a program, and one by each of them where it divides or has a rate."""
    for tree in trees(files):
        nodes = list(ast.walk(tree))
        rates = any(_is_rate(node) for node in nodes)
        for node in nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
                number = float(node.value) if abs(node.value) < 1e9 else 0.0
                if number > 0:
                    yield number
                if number > 1 and rates:
                    yield 1 / number


def _is_rate(node: ast.AST) -> bool:
    if isinstance(node, (ast.BinOp, ast.AugAssign)):
        return isinstance(node.op, ast.Div)
    return isinstance(node, ast.Call) and last_name(node.func) in RATES
