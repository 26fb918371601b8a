/*
 * Reading the clock, and loops that poll the clock.
 *
 * Time stands still while any thread runs, so a loop that reads the clock until it shows a later time
 * would never end. So if a thread reads the clock many times in a row, and does nothing else that is
 * visible to others, the library makes it sleep until the next step of a grid.
 */
#include "library.h"

#include <dlfcn.h>
#include <string.h>

#define NO_WAIT 40              /* a wait of zero length counts like 40 reads, because it is rare */
#define FIRST_STEP 500          /* reads before the first step: importing rclpy alone needs dozens */
#define NEXT_STEPS 10           /* reads before each further step */
#define FINE (SECOND / 1000)    /* the grid for the first steps of a loop */
#define FINE_STEPS 10
#define COARSE (SECOND / 100)   /* the grid for all further steps */

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

/* Count a wait of zero length by this thread. */
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

/* Do not count the read of the clock that most versions of CPython make for each lock: CPython takes a
 * lock for each read of a file. */
void took_a_lock(void)
{
    struct thread *thread = self();
    if (locks_read_the_clock && thread && thread->reads > 0)
        thread->reads--;
}

/* Reset the counts of this thread, because others can see what it sends. */
void sent_something(void)
{
    struct thread *thread = self();
    if (thread)
        thread->reads = thread->empty_waits = thread->steps = 0;
}

/* Return whether a read by the code at an address counts: reads by the C++ library come from Fast DDS,
 * not from the program. */
static bool counts(const void *caller)
{
    static _Atomic uintptr_t known[64]; /* cache: an address and the result in one atomic word */
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
