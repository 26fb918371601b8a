"""
ROS domains that no other test on this machine uses at the same time.

ROS's own ``domain_coordinator`` keeps them apart, also between two checkouts: who has a domain
holds a TCP port that belongs to it.
"""

from __future__ import annotations

from contextlib import ExitStack, suppress
import random

DOMAINS = range(1, 101)
LEFT_TO_OTHERS = 12


def own_domain(until: ExitStack) -> int:
    """
    Return a domain that nobody else has.

    :param until: what gives it back when it is closed
    """
    import domain_coordinator  # ROS's: whoever only collects tests may have none

    shuffled = iter(random.SystemRandom().sample(DOMAINS, len(DOMAINS)))
    return until.enter_context(domain_coordinator.domain_id(lambda: next(shuffled)))


def other_domains(until: ExitStack) -> list[int]:
    """
    Return all domains that nobody else has, but for a few that are left to tests that begin later.

    :param until: what gives them back when it is closed
    """
    import domain_coordinator

    found = []
    for number in random.SystemRandom().sample(DOMAINS, len(DOMAINS) - LEFT_TO_OTHERS):
        with suppress(RuntimeError):  # somebody has it
            found.append(until.enter_context(domain_coordinator.domain_id(lambda: number)))  # noqa: B023
    return found
