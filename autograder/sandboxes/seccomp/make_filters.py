"""
Write the system-call filters that every sandbox loads, one file per processor family.

This tool for developers needs libseccomp and pyseccomp (``pip install pyseccomp``).  The grader
only reads the filters.  After a change, run
``python autograder/sandboxes/seccomp/make_filters.py`` and commit this file and the filters.

The filter is the last layer, after namespaces, dropped capabilities and resource limits.  It
blocks the following, which the other layers allow (tested with real rclpy nodes):

* new namespaces and mounts (as root, there is no user namespace that forbids them),
* socket families that a network namespace does not isolate, such as AF_VSOCK,
* memory that is not part of resident memory: memfd and System V segments,
* the session keyring, ptrace of the sandbox's own init, io_uring, bpf, perf.

All other system calls are allowed, because Python, numpy and Fast DDS need many, which change
from version to version.
"""

import errno
from pathlib import Path

FORBIDDEN = """
    unshare setns mount umount2 pivot_root chroot move_mount fsopen fsmount open_tree
    mount_setattr keyctl add_key request_key ptrace process_vm_readv process_vm_writev
    pidfd_getfd kcmp bpf perf_event_open userfaultfd io_uring_setup io_uring_enter
    io_uring_register open_by_handle_at name_to_handle_at kexec_load kexec_file_load
    init_module finit_module delete_module swapon swapoff reboot settimeofday clock_settime
    clock_adjtime adjtimex quotactl acct syslog memfd_create memfd_secret shmget msgget mq_open
    fanotify_init lookup_dcookie
"""
ALLOWED_FAMILIES = {1, 2, 10, 16}  # AF_UNIX, AF_INET, AF_INET6, AF_NETLINK (linux/socket.h)
NEW_NAMESPACE_FLAGS = (
    0x00000080,  # CLONE_NEWTIME
    0x00020000,  # CLONE_NEWNS
    0x02000000,  # CLONE_NEWCGROUP
    0x04000000,  # CLONE_NEWUTS
    0x08000000,  # CLONE_NEWIPC
    0x10000000,  # CLONE_NEWUSER
    0x20000000,  # CLONE_NEWPID
    0x40000000,  # CLONE_NEWNET
)


def write_filter(arch: str, path: Path) -> None:
    """
    Compile the filter for one processor family.

    :param arch: libseccomp's name, ``'x86_64'`` or ``'aarch64'``
    :param path: file to write, raw ``struct sock_filter`` records
    """
    import pyseccomp as seccomp

    rules = seccomp.SyscallFilter(seccomp.ALLOW)
    target = getattr(seccomp.Arch, arch.upper())
    if target != seccomp.system_arch():
        rules.add_arch(target)
        rules.remove_arch(seccomp.system_arch())
    deny = seccomp.ERRNO(errno.EPERM)
    for name in FORBIDDEN.split():
        rules.add_rule(deny, name)
    # Without clone3(), glibc falls back to clone(), whose flags a filter can inspect.
    rules.add_rule(seccomp.ERRNO(errno.ENOSYS), 'clone3')
    for flag in NEW_NAMESPACE_FLAGS:
        rules.add_rule(deny, 'clone', seccomp.Arg(0, seccomp.MASKED_EQ, flag, flag))
    for family in range(max(ALLOWED_FAMILIES)):
        if family not in ALLOWED_FAMILIES:
            rules.add_rule(deny, 'socket', seccomp.Arg(0, seccomp.EQ, family))
    rules.add_rule(deny, 'socket', seccomp.Arg(0, seccomp.GT, max(ALLOWED_FAMILIES)))
    with path.open('wb') as file:
        rules.export_bpf(file)


if __name__ == '__main__':
    for family_name in ('x86_64', 'aarch64'):
        write_filter(family_name, Path(__file__).parent / f'{family_name}.bpf')
