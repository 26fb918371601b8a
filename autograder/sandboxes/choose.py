"""Choose the strongest isolation that works here, or an accepted weaker one."""

from __future__ import annotations

import functools
import os
import shutil

from autograder.errors import SandboxUnavailable
from autograder.sandboxes import isolation, landlock
from autograder.sandboxes.sandbox import HERE, Sandbox
from autograder.sandboxes.sandbox_trial import try_out


@functools.lru_cache(maxsize=4)
def strongest(allow_weak: str = '') -> Sandbox:
    """
    Return the strongest sandbox that works here, after trying it.

    :param allow_weak: the weakest mode of :data:`autograder.sandboxes.isolation.WEAK` that is
        accepted; empty for nothing but isolation
    :raises SandboxUnavailable: with the exact fix, and the weaker modes that would work
    """
    try:
        return isolated()
    except SandboxUnavailable as error:
        refusal = error
    root = os.geteuid() == 0
    reasons = []
    for mode in isolation.permitted(allow_weak, root):
        try:
            return weak(mode)
        except SandboxUnavailable as error:
            reasons.append(f'{mode}: {error}')
    offers = isolation.permitted(isolation.WEAK[-1], root) if not allow_weak else ()
    if offers:
        reasons.append(
            f'To accept weaker isolation: --allow-weak={" or --allow-weak=".join(offers)}.'
        )
    raise SandboxUnavailable(refusal.what, ' '.join([refusal.fix, *reasons])) from refusal


def isolated() -> Sandbox:
    """
    Return the isolated sandbox that works here.

    :raises SandboxUnavailable: with the exact fix
    """
    if shutil.which('bwrap') is None:
        raise SandboxUnavailable('bubblewrap is not installed.', isolation.FIX_MISSING)
    if not landlock.filter_file().is_file():
        raise SandboxUnavailable(*landlock.NO_FILTER)
    # Never bubblewrap's user namespace as root: the kernel would still see uid 0 inside.
    sandbox = Sandbox('bwrap-root' if os.geteuid() == 0 else 'bwrap-user')
    try_out(sandbox)
    return sandbox


def weak(mode: str) -> Sandbox:
    """
    Return a weaker sandbox.

    :raises SandboxUnavailable: if it does not work here
    """
    sandbox = Sandbox(mode)
    if not sandbox.facts.landlock:
        return sandbox
    what, fix = landlock.refusal(root=sandbox.facts.root)
    if what:
        raise SandboxUnavailable(what, fix)
    if sandbox.facts.root:
        needed = (*sandbox.ros.read_only, str(HERE / 'inside'))
        if folder := landlock.closed_folder(needed):
            raise SandboxUnavailable(
                f'{folder} is closed to other users, and Python or the course is below it.',
                f'Move them, or open the way: chmod o+x {folder}',
            )
    try_out(sandbox)
    return sandbox


def plain() -> Sandbox:
    """Return the sandbox without isolation, for visible checks on one's own code."""
    return Sandbox('none')
