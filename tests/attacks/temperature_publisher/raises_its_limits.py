"""
Tries: raise its limits and its priority, and ask the kernel to spare it when memory runs out.

Stopped by: hard limits and no capability
Deserves: 0
"""

import os
import resource

for name in ('AS', 'NPROC', 'CPU', 'FSIZE', 'NOFILE', 'CORE'):
    kind = getattr(resource, f'RLIMIT_{name}')
    _, hard = resource.getrlimit(kind)
    try:
        resource.setrlimit(kind, (hard + 1, hard + 1))
    except (OSError, ValueError):
        continue
    print('ESCAPED', name)
for what, call in (
    ('nice', lambda: os.setpriority(os.PRIO_PROCESS, 0, -5)),
    ('realtime', lambda: os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))),
):
    try:
        call()
    except OSError:
        continue
    print('ESCAPED', what)
try:
    with open('/proc/self/oom_score_adj', 'w') as file:
        file.write('-1000')
    print('ESCAPED oom_score_adj')
except OSError:
    pass
