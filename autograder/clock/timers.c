/*
 * Timers of the process. setitimer and alarm send a signal. A timerfd is replaced by an eventfd to which
 * the helper thread writes, so poll, epoll and read work without special code.
 */
#include "library.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/eventfd.h>

#define MAX_TIMERS 16

struct timer {
    bool used;
    int fd;             /* descriptor of a timerfd; -1 for the alarm */
    clockid_t clock;
    int64_t next;       /* NEVER if the timer is not set */
    int64_t interval;
};

static struct timer timers[MAX_TIMERS] = {{.used = true, .fd = -1, .next = NEVER}};

void forget_timers(void)
{
    /* A forked child inherits no alarm. Inherited timerfds are not supported; programs do not use them. */
    for (int i = 0; i < MAX_TIMERS; i++)
        timers[i] = (struct timer){.used = i == 0, .fd = -1, .next = NEVER};
}

int64_t first_timer(void)
{
    int64_t first = NEVER;
    for (int i = 0; i < MAX_TIMERS; i++)
        if (timers[i].used && timers[i].next < first)
            first = timers[i].next;
    return first;
}

/* Fire the timer that is due first. */
void fire_timer(void)
{
    struct timer *first = NULL;
    for (int i = 0; i < MAX_TIMERS; i++)
        if (timers[i].used && timers[i].next <= now() && (!first || timers[i].next < first->next))
            first = &timers[i];
    if (!first)
        return;
    first->next = first->interval ? first->next + first->interval : NEVER;
    if (first->fd >= 0)
        eventfd_write(first->fd, 1);
    else
        interrupt_main(SIGALRM);
}

static int64_t of_timeval(struct timeval time) { return time.tv_sec * SECOND + time.tv_usec * 1000; }

static struct timeval to_timeval(int64_t time)
{
    return (struct timeval){time / SECOND, time % SECOND / 1000};
}

static int64_t left(const struct timer *timer)
{
    if (timer->next == NEVER)
        return 0;
    return timer->next > now() ? timer->next - now() : 1;
}

EXPORT int setitimer(__itimer_which_t which, const struct itimerval *restrict value,
                     struct itimerval *restrict before)
{
    if (!self() || which != ITIMER_REAL)
        return REAL(setitimer)(which, value, before);
    lock();
    struct timer *timer = &timers[0];
    if (before)
        *before = (struct itimerval){to_timeval(timer->interval), to_timeval(left(timer))};
    if (value) {
        int64_t first = of_timeval(value->it_value);
        timer->interval = of_timeval(value->it_interval);
        timer->next = first ? deadline_in(first) : NEVER;
    }
    unlock();
    return 0;
}

EXPORT unsigned alarm(unsigned seconds)
{
    struct itimerval value = {{0, 0}, {seconds, 0}}, before;
    setitimer(ITIMER_REAL, &value, &before);
    return (unsigned)(before.it_value.tv_sec + (before.it_value.tv_usec > 0));
}

static struct timer *timer_of(int fd)
{
    for (int i = 1; i < MAX_TIMERS; i++)
        if (timers[i].used && timers[i].fd == fd)
            return &timers[i];
    return NULL;
}

/* Forget the timer of a descriptor that is about to be closed, because its number may be reused. */
void forget_timer(int fd)
{
    lock();
    struct timer *timer = timer_of(fd);
    if (timer)
        *timer = (struct timer){.fd = -1, .next = NEVER};
    unlock();
}

EXPORT int timerfd_create(clockid_t clock, int flags)
{
    if (!self())
        return REAL(timerfd_create)(clock, flags);
    int fd = eventfd(0, (flags & TFD_NONBLOCK ? EFD_NONBLOCK : 0) |
                            (flags & TFD_CLOEXEC ? EFD_CLOEXEC : 0));
    lock();
    struct timer *timer = NULL;
    for (int i = 1; !timer && i < MAX_TIMERS; i++)
        if (!timers[i].used)
            timer = &timers[i];
    if (timer)
        *timer = (struct timer){.used = true, .fd = fd, .clock = clock, .next = NEVER};
    unlock();
    if (!timer) {
        close(fd);
        errno = EMFILE;
        return -1;
    }
    return fd;
}

EXPORT int timerfd_gettime(int fd, struct itimerspec *value)
{
    lock();
    struct timer *timer = self() ? timer_of(fd) : NULL;
    int64_t rest = timer ? left(timer) : 0, interval = timer ? timer->interval : 0;
    unlock();
    if (!timer)
        return REAL(timerfd_gettime)(fd, value);
    *value = (struct itimerspec){{interval / SECOND, interval % SECOND},
                                 {rest / SECOND, rest % SECOND}};
    return 0;
}

EXPORT int timerfd_settime(int fd, int flags, const struct itimerspec *value,
                           struct itimerspec *before)
{
    int64_t first = deadline_at(CLOCK_MONOTONIC, &value->it_value);
    if (before)
        timerfd_gettime(fd, before);
    lock();
    struct timer *timer = self() ? timer_of(fd) : NULL;
    if (!timer) {
        unlock();
        return REAL(timerfd_settime)(fd, flags, value, before);
    }
    timer->interval = deadline_at(CLOCK_MONOTONIC, &value->it_interval);
    if (!first)
        timer->next = NEVER;
    else if (flags & TFD_TIMER_ABSTIME)
        timer->next = deadline_at(timer->clock, &value->it_value);
    else
        timer->next = deadline_in(first);
    unlock();
    return 0;
}
