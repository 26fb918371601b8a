"""
Tries: use system calls in which kernel vulnerabilities were found: io_uring, bpf, userfaultfd,
 keys, handles, new mounts.

Stopped by: a system-call filter
Deserves: 0
Ends: waits_outside
"""

import ctypes
import os

CALLS = {
    'io_uring_setup': 425,
    'bpf': 321,
    'userfaultfd': 323,
    'perf_event_open': 298,
    'add_key': 248,
    'request_key': 249,
    'keyctl': 250,
    'ptrace': 101,
    'process_vm_readv': 310,
    'pidfd_getfd': 438,
    'unshare': 272,
    'setns': 308,
    'mount': 165,
    'pivot_root': 155,
    'chroot': 161,
    'fsopen': 430,
    'open_tree': 428,
    'move_mount': 429,
    'name_to_handle_at': 303,
    'open_by_handle_at': 304,
    'memfd_create': 319,
    'memfd_secret': 447,
    'shmget': 29,
    'msgget': 68,
    'mq_open': 240,
    'fanotify_init': 300,
    'kexec_load': 246,
    'init_module': 175,
    'swapon': 167,
    'reboot': 169,
    'settimeofday': 164,
    'syslog': 103,
    'acct': 163,
    'quotactl': 179,
}
X32 = 0x40000000
libc = ctypes.CDLL(None, use_errno=True)
for name, number in CALLS.items() if os.uname().machine == 'x86_64' else ():
    if libc.syscall(number, 0, 0, 0, 0, 0) >= 0:
        print('ESCAPED', name)
    elif ctypes.get_errno() not in (1, 38):
        print('ESCAPED the filter at', name, ctypes.get_errno())
    if os.fork() == 0:
        # The other ABI of this kernel, which a careless filter forgets.
        if libc.syscall(number | X32, 0, 0, 0, 0, 0) >= 0:
            print('ESCAPED', name, 'as x32')
        os._exit(0)
    os.wait()
