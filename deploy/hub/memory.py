"""A memory limit for each user's server and everything that it starts, by a control group."""

from __future__ import annotations

from pathlib import Path

GROUP = 'ros2_hub'
MIB = 1024 * 1024
HIERARCHIES = (
    ('/sys/fs/cgroup', 'memory.max'),
    ('/sys/fs/cgroup/memory', 'memory.limit_in_bytes'),
)
"""Where control groups are mounted, and the file of the limit: version 2, version 1."""


def group_of(user: str) -> tuple[Path, str] | None:
    """
    Return a user's control group, made if necessary, and the name of the file with its limit.

    :returns: None if this system has no memory controller that this process may use
    """
    for root, name in HIERARCHIES:
        group = Path(root) / GROUP / user
        try:
            group.parent.mkdir(exist_ok=True)
            if (group.parent / 'cgroup.subtree_control').exists():
                (group.parent / 'cgroup.subtree_control').write_text('+memory')
            group.mkdir(exist_ok=True)
        except OSError:
            continue
        if (group / name).exists():
            return group, name
        group.rmdir()
    return None


def limit(user: str, pid: int, mib: int) -> bool:
    """
    Put a process, and so all that it will start, under a limit of memory.

    :param mib: the limit [MiB]
    :returns: False if this system offers none
    """
    found = group_of(user)
    if found is None:
        return False
    group, name = found
    (group / name).write_text(str(mib * MIB))
    (group / 'cgroup.procs').write_text(str(pid))
    return True
