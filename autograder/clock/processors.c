/*
 * The processors that a program sees: four, on every machine.
 *
 * rclpy's MultiThreadedExecutor has one thread per processor, so without this file a recording would
 * depend on the machine. This file also hides that all processes of a run share one processor.
 */
#include "library.h"

#include <errno.h>
#include <string.h>

#define SEEN 4

EXPORT int sched_getaffinity(pid_t process, size_t size, cpu_set_t *set)
{
    if (!active)
        return REAL(sched_getaffinity)(process, size, set);
    if (size < sizeof(unsigned long)) { /* as in the kernel */
        errno = EINVAL;
        return -1;
    }
    memset(set, 0, size);
    for (size_t processor = 0; processor < SEEN; processor++)
        CPU_SET_S(processor, size, set);
    return 0;
}

/* Ignore a program's choice of processors without an error. */
EXPORT int sched_setaffinity(pid_t process, size_t size, const cpu_set_t *set)
{
    return active ? 0 : REAL(sched_setaffinity)(process, size, set);
}

/* ThreadSanitizer calls this function before it can observe calls and before functions are looked up. */
extern long __sysconf(int name);

__attribute__((no_sanitize("thread"))) EXPORT long sysconf(int name)
{
    bool processors = name == _SC_NPROCESSORS_ONLN || name == _SC_NPROCESSORS_CONF;
    return processors && active ? SEEN : __sysconf(name);
}
