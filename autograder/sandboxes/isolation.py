"""
Define the isolation modes, what each does not protect, and the fixes for bubblewrap's errors.

This module contains only data and text; :mod:`autograder.sandboxes.choose` tries the modes.
"""

from dataclasses import dataclass
import os
from pathlib import Path

SHARED_NETWORK = (
    'the network is shared: a program can send to other programs on this machine and, over UDP, '
    'to other machines; any program that finds the ROS domain can take part in the run'
)
SHARED_USER = (
    "the program runs as the grader's own user: it can change permissions and dates of that "
    "user's files, and it shares that user's process limit"
)
SIGNALS = 'before Linux 6.12 the program can end processes of the same user, including the grader'
NAMES = 'the program can see the names and sizes of files, but cannot read the files'
EVERYTHING = (
    'nothing is hidden or protected from the program: it can use the files, programs and network '
    'of the user; only time and memory limits apply'
)


@dataclass(frozen=True)
class Mode:
    """
    One way to isolate a program.

    :param lacks: what the mode does not protect; empty for full isolation
    :param keeps_secrets: whether hidden exams may be run, because programs cannot read them
    :param root: whether the grader must be root (then the program gets a temporary uid) or must
        not be root
    :param namespaces: whether the program has separate file systems and a separate network
    :param landlock: whether Landlock and a system-call filter confine the program
    """

    what: str
    lacks: tuple[str, ...] = ()
    keeps_secrets: bool = True
    root: bool = False
    namespaces: bool = False
    landlock: bool = False


MODES = {
    'bwrap-user': Mode('bubblewrap as a plain user', namespaces=True),
    'bwrap-root': Mode('bubblewrap as root, with a throw-away user', root=True, namespaces=True),
    'landlock-uid': Mode(
        'Landlock with a throw-away user', (SHARED_NETWORK, NAMES), root=True, landlock=True
    ),
    'landlock': Mode(
        'Landlock alone', (SHARED_NETWORK, NAMES, SHARED_USER, SIGNALS), landlock=True
    ),
    'none': Mode('no isolation', (EVERYTHING,), keeps_secrets=False),
}
"""All isolation modes by name, strongest first."""

WEAK = tuple(name for name, mode in MODES.items() if mode.lacks)


def full(root: bool) -> str:
    """Return the mode with full isolation, for root or for a plain user."""
    # As root, do not use bubblewrap's user namespace: the kernel would treat the program as uid 0.
    return next(name for name, mode in MODES.items() if mode.namespaces and mode.root == root)


def permitted(allow_weak: str, root: bool) -> tuple[str, ...]:
    """Return the weak modes that may be tried: the accepted one and all stronger ones."""
    if not allow_weak:
        return ()
    enough = WEAK[: WEAK.index(allow_weak) + 1]
    return tuple(name for name in enough if MODES[name].root == root)


def not_protected(mode: str) -> tuple[str, ...]:
    """Return what a mode does not protect; empty for full isolation and unknown modes."""
    return MODES[mode].lacks if mode in MODES else ()


def banner(mode: str) -> str:
    """Return the warning about a weak mode."""
    lines = [f'WEAK ISOLATION: {MODES[mode].what} ({mode}). One submission at a time.']
    lines += [f'  - {lack}.' for lack in MODES[mode].lacks]
    if not MODES[mode].keeps_secrets:
        lines.append('  Only visible checks are run, and nothing is entered in the gradebook.')
    return '\n'.join([*lines, '  Every result of this run mentions the weak isolation.'])


# -- fixes ---------------------------------------------------------------------------------

SECTION = 'See environment.md, section "Grading refuses".'
FIX_MISSING = (
    'Install bubblewrap 0.8 or newer: sudo apt-get install -y bubblewrap '
    '(Fedora: sudo dnf install -y bubblewrap).'
)
FIX_OLD = (
    'This bubblewrap is older than 0.8 (Ubuntu 22.04 has 0.6): grade on Debian 12 or Ubuntu 24.04 '
    'or put a newer bwrap first on the PATH.'
)
FIX_APPARMOR = (
    'AppArmor blocks user namespaces for bubblewrap here. Until the next restart: sudo sysctl -w '
    'kernel.apparmor_restrict_unprivileged_userns=0. Permanently, a profile for /usr/bin/bwrap: '
    "printf 'abi <abi/4.0>,\\ninclude <tunables/global>\\nprofile bwrap /usr/bin/bwrap "
    "flags=(unconfined) {\\n  userns,\\n}\\n' | sudo tee /etc/apparmor.d/bwrap "
    '&& sudo systemctl reload apparmor. ' + SECTION
)
FIX_CLONE = (
    'This kernel allows user namespaces only for root: sudo sysctl -w '
    'kernel.unprivileged_userns_clone=1.'
)
FIX_COUNT = 'This system allows no user namespaces: sudo sysctl -w user.max_user_namespaces=15000.'
FIX_CONTAINER = (
    'This container forbids what the sandbox needs: start it as a plain user, with '
    '--security-opt seccomp=grader.json --security-opt systempaths=unconfined '
    '--security-opt apparmor=unconfined. See environment.md, section "Container".'
)

KERNEL = (
    ('kernel/apparmor_restrict_unprivileged_userns', ('1', '2'), FIX_APPARMOR),
    ('kernel/unprivileged_userns_clone', ('0',), FIX_CLONE),
    ('user/max_user_namespaces', ('0',), FIX_COUNT),
)
"""Kernel settings, the values with which a plain user cannot use bubblewrap, and the fixes."""


def fix_for(said: str, system: Path = Path('/')) -> str:
    """
    Return the fix for an error message from bubblewrap, or from a program in the sandbox.

    :param system: root of the file system that shows the settings
    """
    if 'nknown option' in said:
        return FIX_OLD
    refused = ('uid map', 'RTM_NEWADDR', 'namespace', 'pivot_root', 'Operation not permitted')
    if not any(word in said for word in refused):
        return SECTION if 'bwrap: ' in said else 'Try: make doctor'
    if any(os.path.exists(system / mark) for mark in ('.dockerenv', 'run/.containerenv')):
        return FIX_CONTAINER
    if os.geteuid() != 0:
        for setting, values, fix in KERNEL:
            try:
                value = (system / 'proc/sys' / setting).read_text('ascii').strip()
            except (OSError, ValueError):
                continue  # the setting is absent, or a container hides it
            if value in values:
                return fix
    return FIX_APPARMOR if 'uid map' in said or 'RTM_NEWADDR' in said else FIX_CONTAINER
