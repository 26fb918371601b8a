/*
 * Waits for descriptors: poll, select, epoll and blocking reads.
 *
 * Before a thread waits, it adds its descriptors to the driver's epoll set. It removes them after it is
 * counted as running again. A datagram on the loopback interface is in its reader's queue when the call
 * that sent it returns. So if all threads wait and the set has no event, no datagram is on its way.
 */
#include "library.h"

#include <alloca.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/select.h>

static struct { short waiters, reading, writing, urgent; } registered[MAX_FDS];

void forget_descriptors(void) { memset(registered, 0, sizeof registered); }

/* Update the driver's epoll set after the waiters of a descriptor have changed. */
static void update_in_flight(int fd)
{
    struct epoll_event event = {.data.fd = fd};
    if (registered[fd].reading)
        event.events |= EPOLLIN;
    if (registered[fd].writing)
        event.events |= EPOLLOUT;
    if (registered[fd].urgent)
        event.events |= EPOLLPRI;
    if (!registered[fd].waiters)
        epoll_ctl(in_flight, EPOLL_CTL_DEL, fd, &event);
    else if (epoll_ctl(in_flight, EPOLL_CTL_MOD, fd, &event) < 0) /* new, or another file by now */
        epoll_ctl(in_flight, EPOLL_CTL_ADD, fd, &event);
}

/* Add waiters for descriptors (change = 1) or remove them (change = -1); the caller holds the lock. */
static void change_waiters(const struct pollfd *fds, nfds_t count, short change)
{
    int before = errno;
    for (nfds_t i = 0; i < count; i++) {
        int fd = fds[i].fd;
        if (fd < 0 || fd >= MAX_FDS)
            continue;
        registered[fd].waiters += change;
        registered[fd].reading += fds[i].events & POLLIN ? change : 0;
        registered[fd].writing += fds[i].events & POLLOUT ? change : 0;
        registered[fd].urgent += fds[i].events & POLLPRI ? change : 0;
        update_in_flight(fd);
    }
    errno = before;
}

/* Wait once; `all` has space for `count` + 1 entries, the last for the thread's own eventfd. */
static enum why wait_for_descriptors(struct thread *thread, struct pollfd *all, nfds_t count,
                                     int64_t deadline)
{
    eventfd_t times;
    lock();
    if (thread->eventfd < 0)
        thread->eventfd = keep_open(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    all[count] = (struct pollfd){.fd = thread->eventfd, .events = POLLIN};
    change_waiters(all, count, 1);
    thread->in_poll = true;
    begin_wait(thread, thread, deadline);
    unlock();
    bool signalled = REAL(poll)(all, count + 1, -1) < 0;
    wait_for_portion();
    lock();
    enum why why = end_wait(thread);
    thread->in_poll = false;
    change_waiters(all, count, -1);
    if (why != BY_ITSELF)
        eventfd_read(thread->eventfd, &times);
    unlock();
    return signalled ? INTERRUPTED : why;
}

/* Poll with a deadline in virtual time. */
int poll_until(struct pollfd *fds, nfds_t count, int64_t deadline)
{
    struct thread *thread = self();
    struct pollfd *all = alloca((count + 1) * sizeof *all);
    int result = REAL(poll)(fds, count, 0);
    if (result == 0 && deadline <= now())
        waited_for_nothing();
    else
        deadline = with_slack(deadline);
    /* If another thread reads the data first, this thread continues to wait. */
    while (result == 0 && deadline > now()) {
        memcpy(all, fds, count * sizeof *all);
        enum why why = wait_for_descriptors(thread, all, count, deadline);
        if (why == INTERRUPTED) {
            errno = EINTR;
            return -1;
        }
        result = REAL(poll)(fds, count, 0);
    }
    return result;
}

static int64_t after_ms(int timeout)
{
    return timeout < 0 ? NEVER : deadline_in(timeout * MILLISECOND);
}

static int64_t after(const struct timespec *timeout)
{
    return timeout ? deadline_in(deadline_at(CLOCK_MONOTONIC, timeout)) : NEVER;
}

EXPORT int poll(struct pollfd *fds, nfds_t count, int timeout)
{
    return self() ? poll_until(fds, count, after_ms(timeout)) : REAL(poll)(fds, count, timeout);
}

/* Return the result of a wait; during the wait, set the signal mask if one is given. */
#define RETURN_WITH_MASK(mask, wait) \
    sigset_t before; \
    if (mask) \
        pthread_sigmask(SIG_SETMASK, mask, &before); \
    int result = wait; \
    if (mask) \
        pthread_sigmask(SIG_SETMASK, &before, NULL); \
    return result

EXPORT int ppoll(struct pollfd *fds, nfds_t count, const struct timespec *timeout,
                 const sigset_t *mask)
{
    if (!self())
        return REAL(ppoll)(fds, count, timeout, mask);
    RETURN_WITH_MASK(mask, poll_until(fds, count, after(timeout)));
}

static int select_until(int count, fd_set *sets[3], int64_t deadline)
{
    static const short asked[3] = {POLLIN, POLLOUT, POLLPRI};
    static const short shown[3] = {POLLIN | POLLHUP | POLLERR, POLLOUT | POLLERR, POLLPRI};
    struct pollfd fds[FD_SETSIZE];
    nfds_t used = 0;
    for (int fd = 0; fd < count && fd < FD_SETSIZE; fd++) {
        short events = 0;
        for (int i = 0; i < 3; i++)
            if (sets[i] && FD_ISSET(fd, sets[i]))
                events |= asked[i];
        if (events)
            fds[used++] = (struct pollfd){.fd = fd, .events = events};
    }
    int result = poll_until(fds, used, deadline);
    if (result < 0)
        return result;
    int ready = 0;
    for (nfds_t k = 0; k < used; k++) {
        if (fds[k].revents & POLLNVAL) {
            errno = EBADF;
            return -1;
        }
        for (int i = 0; i < 3; i++) {
            if (!sets[i] || !FD_ISSET(fds[k].fd, sets[i]))
                continue;
            if (fds[k].revents & shown[i])
                ready++;
            else
                FD_CLR(fds[k].fd, sets[i]);
        }
    }
    return ready;
}

EXPORT int select(int count, fd_set *reading, fd_set *writing, fd_set *other,
                  struct timeval *timeout)
{
    struct timespec time = {0};
    if (timeout)
        time = (struct timespec){timeout->tv_sec, timeout->tv_usec * 1000};
    fd_set *sets[3] = {reading, writing, other};
    if (!self())
        return REAL(pselect)(count, reading, writing, other, timeout ? &time : NULL, NULL);
    return select_until(count, sets, after(timeout ? &time : NULL));
}

EXPORT int pselect(int count, fd_set *reading, fd_set *writing, fd_set *other,
                   const struct timespec *timeout, const sigset_t *mask)
{
    fd_set *sets[3] = {reading, writing, other};
    if (!self())
        return REAL(pselect)(count, reading, writing, other, timeout, mask);
    RETURN_WITH_MASK(mask, select_until(count, sets, after(timeout)));
}

static int epoll_until(int epoll, struct epoll_event *events, int most, int64_t deadline)
{
    struct pollfd one = {.fd = epoll, .events = POLLIN};
    int result = REAL(epoll_wait)(epoll, events, most, 0);
    while (result == 0 && (result = poll_until(&one, 1, deadline)) > 0)
        if ((result = REAL(epoll_wait)(epoll, events, most, 0)) != 0)
            break; /* if the result is 0, another thread has taken the events: wait again */
    return result;
}

EXPORT int epoll_wait(int epoll, struct epoll_event *events, int most, int timeout)
{
    if (!self())
        return REAL(epoll_wait)(epoll, events, most, timeout);
    return epoll_until(epoll, events, most, after_ms(timeout));
}

EXPORT int epoll_pwait(int epoll, struct epoll_event *events, int most, int timeout,
                       const sigset_t *mask)
{
    RETURN_WITH_MASK(mask, epoll_wait(epoll, events, most, timeout));
}

/* -- reads that block -- */

static bool blocks(int fd)
{
    int flags = fcntl(fd, F_GETFL);
    return flags >= 0 && !(flags & O_NONBLOCK);
}

/* Wait before a call that would block; return false, with errno set, if the caller must not make it. */
static bool ready_to_read(int fd, int flags)
{
    struct pollfd one = {.fd = fd, .events = POLLIN};
    struct timeval limit = {0};
    socklen_t size = sizeof limit;
    int64_t deadline = NEVER;
    if (!self() || flags & MSG_DONTWAIT || REAL(poll)(&one, 1, 0) != 0 || !blocks(fd))
        return true;
    if (getsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, &size) == 0 &&
        (limit.tv_sec || limit.tv_usec))
        deadline = deadline_in(limit.tv_sec * SECOND + limit.tv_usec * 1000);
    int result = poll_until(&one, 1, deadline);
    if (result == 0)
        errno = EAGAIN;
    return result > 0;
}

EXPORT ssize_t read(int fd, void *into, size_t size)
{
    return ready_to_read(fd, 0) ? REAL(read)(fd, into, size) : -1;
}

/* Return whether a socket was shut down. Such a socket is always readable; a non-blocking receive fails
 * with EAGAIN, but a blocking one returns at once. Fast DDS ends its threads in this way. */
static bool is_shut_down(int fd)
{
    struct pollfd one = {.fd = fd, .events = POLLRDHUP};
    return REAL(poll)(&one, 1, 0) > 0 && one.revents & POLLRDHUP;
}

/* Receive after waiting in virtual time. The receive itself does not block, because another thread may
 * have read the data first. */
#define RECEIVE(fd, flags, call) \
    if (!self() || (flags) & MSG_DONTWAIT || !blocks(fd)) \
        return call(flags); \
    for (;;) { \
        if (!ready_to_read(fd, flags)) \
            return -1; \
        ssize_t got = call((flags) | MSG_DONTWAIT); \
        if (got > 0) \
            begin_receiving(); \
        if (got >= 0 || errno != EAGAIN) \
            return got; \
        if (is_shut_down(fd)) \
            return call(flags); \
    }

EXPORT ssize_t recv(int fd, void *into, size_t size, int flags)
{
#define CALL(how) REAL(recv)(fd, into, size, how)
    RECEIVE(fd, flags, CALL)
#undef CALL
}

EXPORT ssize_t recvfrom(int fd, void *restrict into, size_t size, int flags,
                        struct sockaddr *restrict from, socklen_t *restrict length)
{
#define CALL(how) REAL(recvfrom)(fd, into, size, how, from, length)
    RECEIVE(fd, flags, CALL)
#undef CALL
}

EXPORT ssize_t recvmsg(int fd, struct msghdr *message, int flags)
{
#define CALL(how) REAL(recvmsg)(fd, message, how)
    RECEIVE(fd, flags, CALL)
#undef CALL
}

EXPORT int accept(int fd, struct sockaddr *restrict from, socklen_t *restrict length)
{
    return ready_to_read(fd, 0) ? REAL(accept)(fd, from, length) : -1;
}

EXPORT int accept4(int fd, struct sockaddr *restrict from, socklen_t *restrict length, int flags)
{
    return ready_to_read(fd, 0) ? REAL(accept4)(fd, from, length, flags) : -1;
}

/* -- sends, which others can see (clocks.c); datagrams are posted (datagrams.c) -- */

EXPORT ssize_t sendmsg(int fd, const struct msghdr *message, int flags)
{
    sent_something();
    ssize_t size = post(fd, message, flags);
    return size >= 0 ? size : REAL(sendmsg)(fd, message, flags);
}

EXPORT ssize_t sendto(int fd, const void *data, size_t size, int flags,
                      const struct sockaddr *to, socklen_t length)
{
    struct iovec part = {(void *)data, size};
    struct msghdr message = {.msg_name = (void *)to, .msg_namelen = to ? length : 0,
                             .msg_iov = &part, .msg_iovlen = 1};
    return sendmsg(fd, &message, flags);
}

EXPORT ssize_t send(int fd, const void *data, size_t size, int flags)
{
    sent_something();
    return REAL(send)(fd, data, size, flags);
}

/* -- closing; the library's own descriptors stay open -- */

EXPORT int close(int fd)
{
    if (is_ours(fd))
        return 0;
    wait_for_post(fd);
    if (self())
        forget_timer(fd);
    return REAL(close)(fd);
}

EXPORT int close_range(unsigned first, unsigned last, int flags)
{
    int result = 0;
    if (!active)
        return REAL(close_range)(first, last, flags);
    for (unsigned fd = first; fd < MAX_FDS && fd <= last; fd++)
        if (is_ours((int)fd)) {
            if (fd > first)
                result = REAL(close_range)(first, fd - 1, flags);
            first = fd + 1;
        }
    return first <= last ? REAL(close_range)(first, last, flags) : result;
}

EXPORT void closefrom(int first) { close_range((unsigned)first, ~0U, 0); }
