"""
Claim ROS domains that no other test and no notebook on this machine uses at the same time.

Two kinds of claims keep them apart, even between two checkouts: the course's own, which kernels
respect, and the TCP port of ROS's ``domain_coordinator``, which the tests of the ROS package use.
"""

from contextlib import closing, ExitStack, suppress
import random

from environment.ros_domain import claim

DOMAINS = range(1, 101)
LEFT_TO_OTHERS = 12


def own_domain(until: ExitStack) -> int:
    """
    Return a domain that no other program has claimed.

    :param until: the stack that returns the domain when it closes
    """
    found = _claimed(until, random.SystemRandom().sample(DOMAINS, len(DOMAINS)), most=1)
    if not found:
        raise RuntimeError('expected a free ROS domain, but all are claimed')
    return found[0]


def other_domains(until: ExitStack) -> list[int]:
    """
    Return all unclaimed domains, except for some that are left for tests that begin later.

    :param until: the stack that returns the domains when it closes
    """
    chosen = random.SystemRandom().sample(DOMAINS, len(DOMAINS) - LEFT_TO_OTHERS)
    return _claimed(until, chosen, most=len(chosen))


def _claimed(until: ExitStack, numbers: list[int], most: int) -> list[int]:
    # Part of ROS, which may be missing if pytest only collects the tests.
    import domain_coordinator

    found: list[int] = []
    for number in numbers:
        if len(found) == most:
            break
        with suppress(RuntimeError), ExitStack() as held:
            held.enter_context(domain_coordinator.domain_id(lambda: number))  # noqa: B023
            if (claimed := claim([number])) is not None:
                held.enter_context(closing(claimed.holder))
                until.push(held.pop_all())
                found.append(number)
    return found
