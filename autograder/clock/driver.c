/*
 * The driver owns the virtual clock of one run and advances it.
 *
 *     driver REALTIME_NS TIME_FD SOCKET...
 *
 * REALTIME_NS is the system time at which the run begins. TIME_FD is a memfd for the time page. Each
 * SOCKET is one end of a SEQPACKET pair with SO_PASSCRED; a process of the run has the other end. If
 * several processes are due at the same time, the driver wakes them in the order of the command line, and
 * then children, the oldest first.
 *
 * Time advances when every process is IDLE, no descriptor that a thread waits for can be read, and no
 * process has changed its state since (README.md explains why). The driver uses no other data from a
 * process. A process that reports a wrong state or deadline affects only its own wake-ups.
 */
#define _GNU_SOURCE
#include "protocol.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/futex.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#define MAX_PROCESSES 128     /* at the same time; a sandbox allows 64 */
#define START (1000 * SECOND) /* virtual CLOCK_MONOTONIC at the start; no program expects 0 */

/* The meaning of an event of the driver's own epoll set, in the low two bits of the event's data. */
enum { SAYS_SOMETHING, IS_NOW_IDLE, HAS_ENDED, MEANING_BITS = 3 };

struct process {
    struct process *next;
    struct process_page *page;
    int page_fd, socket, idle, wake, in_flight, pidfd;
    bool gone;
    int root;      /* its position on the command line, or -1 for a child */
    uint32_t seen; /* its word at the first look */
};

/* The processes in the order in which the driver serves them, and ended ones that are not freed yet. */
static struct process *processes, *gone;
static struct process *posting;          /* the process that sends a portion of datagrams */
static int count;
static struct time_page *timing;
static int time_fd, all_in_flight, own_events;

static int checked(int result, const char *what)
{
    if (result < 0) {
        fprintf(stderr, "virtual clock: %s: %s\n", what, strerror(errno));
        exit(1);
    }
    return result;
}

static void *map(int fd, size_t size)
{
    void *page = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    return page == MAP_FAILED ? NULL : page;
}

static bool listen_to(int fd, struct process *process, int meaning, uint32_t kind)
{
    struct epoll_event event = {.events = kind, .data.u64 = (uintptr_t)process | (unsigned)meaning};
    return epoll_ctl(own_events, EPOLL_CTL_ADD, fd, &event) == 0;
}

/* Close a descriptor that a process sent; without this option, closing a socket could block. */
static void discard(int fd)
{
    struct linger at_once = {.l_onoff = 1, .l_linger = 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    close(fd);
}

/* Remove the descriptors that the threads of a process wait for. */
static void drop_in_flight(struct process *process)
{
    if (process->in_flight >= 0) {
        epoll_ctl(all_in_flight, EPOLL_CTL_DEL, process->in_flight, NULL);
        close(process->in_flight);
    }
    process->in_flight = -1;
}

/* Wake the readers of a portion's first datagrams, because the whole portion has been sent. */
static void end_portion(void)
{
    posting = NULL;
    atomic_store(&timing->posting, 0);
    syscall(SYS_futex, &timing->posting, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

/* Remove a process that has ended and can send nothing more. */
static void let_go(struct process *process)
{
    struct process **link = &processes;
    while (*link != process)
        link = &(*link)->next;
    *link = process->next;
    process->next = gone; /* free it later: other events of the same batch may refer to it */
    gone = process;
    process->gone = true;
    if (process == posting)
        end_portion();
    count--;
    if (process->root >= 0)
        atomic_store(&timing->ended[process->root], atomic_load(&timing->now));
    drop_in_flight(process);
    if (process->page)
        munmap(process->page, sizeof *process->page);
    int held[] = {process->page_fd, process->socket, process->idle, process->wake, process->pidfd};
    for (size_t i = 0; i < sizeof held / sizeof *held; i++)
        if (held[i] >= 0)
            close(held[i]);
}

/* Add a process. It is BUSY, so time stands still until it reports or ends. */
static bool adopt(int socket, int root)
{
    struct process *process = calloc(1, sizeof *process);
    struct process **last = &processes;
    int type = 0;
    socklen_t size = sizeof type;
    if (!process)
        exit(1);
    while (*last)
        last = &(*last)->next;
    *last = process;
    count++;
    process->socket = socket;
    process->root = root;
    process->pidfd = process->in_flight = -1;
    process->page_fd = memfd_create("process", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    process->idle = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    process->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK); /* do not block if the process fills it */
    getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size);
    if (type != SOCK_SEQPACKET)
        discard(socket), process->socket = -1;
    if (count <= MAX_PROCESSES && process->socket >= 0 && process->idle >= 0 && process->wake >= 0 &&
        ftruncate(process->page_fd, sizeof *process->page) == 0 &&
        fcntl(process->page_fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0 &&
        (process->page = map(process->page_fd, sizeof *process->page)) &&
        listen_to(socket, process, SAYS_SOMETHING, EPOLLIN) &&
        /* Edge-triggered, so a report needs no read, and many reports are one event. */
        listen_to(process->idle, process, IS_NOW_IDLE, EPOLLIN | EPOLLET))
        return true;
    let_go(process); /* too many processes: the library gets no reply and ends this one */
    return false;
}

/* Reply to HELLO. A new program image gets a new, empty set of descriptors that it waits for. */
static void send_descriptors(struct process *process)
{
    struct epoll_event any = {.events = EPOLLIN};
    drop_in_flight(process);
    process->in_flight = epoll_create1(EPOLL_CLOEXEC);
    if (epoll_ctl(all_in_flight, EPOLL_CTL_ADD, process->in_flight, &any) < 0)
        return;
    int fds[DESCRIPTORS] = {time_fd, process->page_fd, process->in_flight, process->idle,
                            process->wake};
    union {
        char bytes[CMSG_SPACE(sizeof fds)];
        struct cmsghdr aligned;
    } control = {0};
    char byte = HELLO;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1,
        .msg_control = control.bytes, .msg_controllen = sizeof control.bytes,
    };
    struct cmsghdr *header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof fds);
    memcpy(CMSG_DATA(header), fds, sizeof fds);
    sendmsg(process->socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/* Use the first descriptor of an ADOPT message; close all others. */
static void take_descriptors(const struct cmsghdr *header, char what)
{
    size_t number = (header->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (size_t i = 0; i < number; i++) {
        int fd;
        memcpy(&fd, CMSG_DATA(header) + i * sizeof fd, sizeof fd);
        if (what == ADOPT && i == 0)
            adopt(fd, -1);
        else
            discard(fd);
    }
}

static void watch_for_end(struct process *process, pid_t pid)
{
    if (process->pidfd >= 0)
        return; /* exec: a new program image in the same process */
    process->pidfd = (int)syscall(SYS_pidfd_open, pid, 0);
    if (process->pidfd >= 0)
        checked(listen_to(process->pidfd, process, HAS_ENDED, EPOLLIN) ? 0 : -1, "epoll_ctl");
}

/* Handle one message of a process; return false if it has sent none. */
static bool hear(struct process *process)
{
    union {
        char bytes[CMSG_SPACE(sizeof(struct ucred)) + CMSG_SPACE(8 * sizeof(int))];
        struct cmsghdr aligned;
    } control;
    char what = 0;
    struct iovec data = {&what, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1,
        .msg_control = control.bytes, .msg_controllen = sizeof control.bytes,
    };
    ssize_t got = recvmsg(process->socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    if (got < 0 && (errno == EAGAIN || errno == EINTR))
        return false;
    if (got <= 0) {
        /* A process can close its socket and continue; only its pidfd proves that it has ended. */
        epoll_ctl(own_events, EPOLL_CTL_DEL, process->socket, NULL);
        if (process->pidfd < 0)
            let_go(process);
        return false;
    }
    struct cmsghdr *header = CMSG_FIRSTHDR(&message);
    for (; header; header = CMSG_NXTHDR(&message, header)) {
        if (header->cmsg_type == SCM_RIGHTS)
            take_descriptors(header, what);
        else if (header->cmsg_type == SCM_CREDENTIALS && what == HELLO)
            watch_for_end(process, ((const struct ucred *)CMSG_DATA(header))->pid);
    }
    if (what == HELLO)
        send_descriptors(process);
    return true;
}

/* Handle all pending events; if `wait` is set, wait for the first. Return whether an event was handled. */
static bool handle(bool wait)
{
    struct epoll_event events[32];
    int number = epoll_wait(own_events, events, 32, wait ? -1 : 0);
    for (int i = 0; i < number; i++) {
        uintptr_t data = events[i].data.u64;
        struct process *process = (struct process *)(data & ~(uintptr_t)MEANING_BITS);
        int meaning = data & MEANING_BITS;
        if (process->gone || meaning == IS_NOW_IDLE)
            continue;
        if (meaning == SAYS_SOMETHING) {
            hear(process);
            continue;
        }
        while (hear(process))
            ; /* it may have announced children just before it ended */
        if (!process->gone)
            let_go(process);
    }
    while (gone) {
        struct process *next = gone->next;
        free(gone);
        gone = next;
    }
    return number > 0;
}

static bool all_are_idle(void)
{
    for (struct process *process = processes; process; process = process->next) {
        process->seen = atomic_load(&process->page->word);
        if ((process->seen & STATE_BITS) != IDLE)
            return false;
    }
    return true;
}

static bool nothing_changed(void)
{
    for (struct process *process = processes; process; process = process->next)
        if (atomic_load(&process->page->word) != process->seen)
            return false;
    return true;
}

/* Return the process with the earliest deadline; if several have it, the first in order. */
static struct process *first_due(int64_t *deadline)
{
    struct process *first = NULL;
    *deadline = NEVER;
    for (struct process *process = processes; process; process = process->next) {
        int64_t its = atomic_load(&process->page->deadline);
        if (its < *deadline) {
            *deadline = its;
            first = process;
        }
    }
    return first;
}

/* Advance time to the earliest deadline if every process waits. Return whether to try again at once. */
static bool advance(void)
{
    struct epoll_event unused;
    int64_t deadline;
    if (!all_are_idle())
        return false;
    if (handle(false))
        return true; /* a process sent a message before it became idle: an ADOPT, for example */
    if (epoll_wait(all_in_flight, &unused, 1, 0) != 0 || !nothing_changed())
        return false; /* a thread is about to read, and its process will report again */
    struct process *process = first_due(&deadline);
    if (!process)
        return false; /* all processes wait without a deadline; only an outside event can wake one */
    uint32_t word = process->seen;
    uint32_t claimed = ((word & ~(uint32_t)STATE_BITS) + ONE_CHANGE) | CLAIMED;
    if (!atomic_compare_exchange_strong(&process->page->word, &word, claimed))
        return false;
    if (deadline > atomic_load(&timing->now))
        atomic_store(&timing->now, deadline);
    posting = deadline == POST ? process : NULL;
    atomic_store(&timing->posting, posting != NULL);
    eventfd_write(process->wake, 1);
    return true;
}

/* Set up the time page, and seal it: later mappings must be read-only, even if a process opens the page
 * through /proc/self/fd/N for writing. */
static void set_time(int64_t realtime)
{
    checked(ftruncate(time_fd, sizeof *timing), "ftruncate");
    timing = map(time_fd, sizeof *timing);
    checked(timing ? 0 : -1, "mmap");
    int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;
    checked(fcntl(time_fd, F_ADD_SEALS, seals), "seal");
    atomic_store(&timing->now, START);
    timing->to_realtime = realtime - START;
}

int main(int argc, char **argv)
{
    if (argc < 4 || argc > 3 + ROOTS) {
        fprintf(stderr, "usage: driver REALTIME_NS TIME_FD SOCKET...\n");
        return 2;
    }
    struct rlimit files;
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    time_fd = atoi(argv[2]);
    set_time(strtoll(argv[1], NULL, 10));
    all_in_flight = checked(epoll_create1(EPOLL_CLOEXEC), "epoll_create1");
    own_events = checked(epoll_create1(EPOLL_CLOEXEC), "epoll_create1");
    for (int i = 3; i < argc; i++)
        checked(adopt(atoi(argv[i]), i - 3) ? 0 : -1, "socket");
    while (processes) {
        if (posting && (atomic_load(&posting->page->word) & STATE_BITS) == IDLE)
            end_portion();
        if (!advance())
            handle(true);
    }
    return 0;
}
