/*
 * Reading the clock, and loops that do nothing else.
 *
 * Time stands still while anything runs, so a loop that reads the clock until it shows a later time
 * would never end. A thread that reads it many times in a row, and does nothing else that anybody could
 * notice, is therefore taken as one that sleeps until the next step of a grid.
 */
#include "library.h"

#include <dlfcn.h>
#include <string.h>

#define NO_WAIT 40              /* reads that a wait of no time counts for: no program needs many */
#define FIRST_STEP 500          /* importing rclpy alone reads the clock dozens of times */
#define NEXT_STEPS 10
#define FINE (SECOND / 1000)    /* the grid, for the first steps of a loop ... */
#define FINE_STEPS 10
#define COARSE (SECOND / 100)   /* ... and for the others */

/* Sleep until the next step of the grid. */
static void step(struct thread *thread)
{
    int steps = thread->steps + 1;
    int64_t grid = steps > FINE_STEPS ? COARSE : FINE;
    lock();
    sleep_polling(thread, (now() / grid + 1) * grid);
    thread->steps = steps;
    unlock();
}

static void look(struct thread *thread, int *counter)
{
    if (interpreter_wanted)
        thread->reads = thread->empty_waits = thread->steps = 0;
    *counter += 1;
    int looks = thread->reads + NO_WAIT * thread->empty_waits;
    if (looks >= (thread->steps ? NEXT_STEPS : FIRST_STEP))
        step(thread);
}

/* Note that this thread waited for no time at all. */
void waited_for_nothing(void)
{
    struct thread *thread = self();
    if (thread)
        look(thread, &thread->empty_waits);
}

static void read_the_clock(void)
{
    struct thread *thread = self();
    if (thread)
        look(thread, &thread->reads);
}

/* Most CPythons read the clock for each lock that they take, and take one for each read of a file. */
void took_a_lock(void)
{
    struct thread *thread = self();
    if (locks_read_the_clock && thread && thread->reads > 0)
        thread->reads--;
}

/* A thread that sends does something that others notice. */
void sent_something(void)
{
    struct thread *thread = self();
    if (thread)
        thread->reads = thread->empty_waits = thread->steps = 0;
}

/* Whether a read by the code at an address counts: the C++ library's is Fast DDS's, not a program's. */
static bool counts(const void *caller)
{
    static _Atomic uintptr_t known[64]; /* an address and the answer, in one word for all threads */
    uintptr_t address = (uintptr_t)caller << 1, found = known[address / 16 % 64];
    if ((found & ~(uintptr_t)1) != address) {
        Dl_info where = {0};
        dladdr(caller, &where);
        found = address | (!where.dli_fname || !strstr(where.dli_fname, "libstdc++"));
        known[address / 16 % 64] = found;
    }
    return found & 1;
}

EXPORT int clock_gettime(clockid_t clock, struct timespec *time)
{
    bool is_realtime = false;
    if (!active)
        return REAL(clock_gettime)(clock, time);
    switch (clock) {
    case CLOCK_MONOTONIC:
    case CLOCK_MONOTONIC_RAW:
    case CLOCK_MONOTONIC_COARSE:
    case CLOCK_BOOTTIME:
        break;
    case CLOCK_REALTIME:
    case CLOCK_REALTIME_COARSE:
    case CLOCK_TAI:
        is_realtime = true;
        break;
    default: /* processor time */
        return REAL(clock_gettime)(clock, time);
    }
    if (counts(__builtin_return_address(0)))
        read_the_clock();
    int64_t at = is_realtime ? realtime() : now();
    *time = (struct timespec){at / SECOND, at % SECOND};
    return 0;
}

EXPORT int gettimeofday(struct timeval *restrict time, void *restrict zone)
{
    struct timespec at;
    if (!active)
        return REAL(gettimeofday)(time, zone);
    clock_gettime(CLOCK_REALTIME, &at);
    *time = (struct timeval){at.tv_sec, at.tv_nsec / 1000};
    return 0;
}

EXPORT time_t time(time_t *into)
{
    struct timespec at;
    clock_gettime(CLOCK_REALTIME, &at);
    if (into)
        *into = at.tv_sec;
    return at.tv_sec;
}
