"""Limit the memory of each user's server and its child processes with a control group."""

from pathlib import Path

GROUP = 'ros2_hub'
MIB = 1024 * 1024
HIERARCHIES = (
    ('/sys/fs/cgroup', 'memory.max'),
    ('/sys/fs/cgroup/memory', 'memory.limit_in_bytes'),
)
"""Mount points of control groups and names of the limit file: version 2, then version 1."""


def group_of(user: str) -> tuple[Path, str] | None:
    """
    Return a user's control group, created if necessary, and the name of the file with its limit.

    :returns: None if this process cannot use a memory controller on this system
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
    Limit the memory of a process and of all its future child processes.

    :param mib: memory limit [MiB]
    :returns: False if the system provides no memory limits
    """
    found = group_of(user)
    if found is None:
        return False
    group, name = found
    (group / name).write_text(str(mib * MIB))
    (group / 'cgroup.procs').write_text(str(pid))
    return True
