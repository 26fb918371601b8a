/* Connect the process to the clock, and run the helper thread that serves the driver. */
#include "library.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define FIRST_OWN 128 /* first number of the library's descriptors, above those of most programs */

int in_flight = -1, our_socket = -1;

static _Atomic unsigned char ours[MAX_FDS]; /* whether a descriptor is the library's own */
static struct process_page *page;
static struct time_page *timing;
static int wake_up = -1;

bool is_ours(int fd) { return fd >= 0 && fd < MAX_FDS && ours[fd]; }

int keep_open(int fd)
{
    int high = fcntl(fd, F_DUPFD_CLOEXEC, FIRST_OWN);
    if (high < 0 || high >= MAX_FDS)
        return fd;
    REAL(close)(fd);
    ours[high] = 1;
    return high;
}

static _Noreturn void give_up(const char *why)
{
    REAL(write)(2, why, strlen(why));
    _exit(127);
}

/* Request the descriptors of this process from the driver. */
static void receive_descriptors(int socket, int fds[DESCRIPTORS])
{
    union {
        char bytes[CMSG_SPACE(DESCRIPTORS * sizeof(int))];
        struct cmsghdr aligned;
    } control;
    char byte = HELLO;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1,
        .msg_control = control.bytes, .msg_controllen = sizeof control.bytes,
    };
    ssize_t got = REAL(send)(socket, &byte, 1, MSG_NOSIGNAL);
    while (got == 1 && (got = REAL(recvmsg)(socket, &message, 0)) < 0 && errno == EINTR)
        got = 1;
    struct cmsghdr *header = got == 1 ? CMSG_FIRSTHDR(&message) : NULL;
    if (!header || header->cmsg_len != CMSG_LEN(DESCRIPTORS * sizeof(int)))
        give_up("virtual clock: the driver does not answer\n");
    memcpy(fds, CMSG_DATA(header), DESCRIPTORS * sizeof(int));
}

static void *serve_driver(void *unused)
{
    struct pollfd one = {.fd = wake_up, .events = POLLIN};
    uint64_t times;
    leave_clock();
    for (;;) {
        REAL(poll)(&one, 1, -1);
        if (REAL(read)(wake_up, &times, sizeof times) != sizeof times)
            continue;
        lock();
        wake_due();
        unlock();
    }
    return unused;
}

/* Start the helper thread with all signals blocked, because the program's threads must handle them. */
static void start_helper(void)
{
    sigset_t all, before;
    pthread_t id;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (REAL(pthread_create)(&id, NULL, serve_driver, NULL) != 0)
        give_up("virtual clock: no thread for the driver\n");
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static void connect_to_driver(int socket)
{
    int fds[DESCRIPTORS];
    receive_descriptors(socket, fds);
    timing = mmap(NULL, sizeof *timing, PROT_READ, MAP_SHARED, fds[TIME_PAGE], 0);
    page = mmap(NULL, sizeof *page, PROT_READ | PROT_WRITE, MAP_SHARED, fds[PROCESS_PAGE], 0);
    if (timing == MAP_FAILED || page == MAP_FAILED)
        give_up("virtual clock: no memory\n");
    REAL(close)(fds[TIME_PAGE]);
    REAL(close)(fds[PROCESS_PAGE]);
    in_flight = keep_open(fds[IN_FLIGHT]);
    wake_up = keep_open(fds[WAKE_UP]);
    our_socket = socket;
    if (socket < MAX_FDS)
        ours[socket] = 1;
    begin_threads(page, timing, keep_open(fds[IS_IDLE]));
    active = true;
    start_helper();
}

/* Connect the child of a fork, which has one thread, with its own page and descriptors. */
void begin_again_in_child(int socket)
{
    active = false;
    for (int fd = 0; fd < MAX_FDS; fd++)
        if (ours[fd])
            REAL(close)(fd);
    memset((void *)ours, 0, sizeof ours);
    munmap(page, sizeof *page);
    munmap(timing, sizeof *timing);
    forget_descriptors();
    forget_timers();
    forget_post();
    connect_to_driver(socket);
}

/* Join the clock later than at the start, for example in a fork of a process that is not on the clock. */
EXPORT void join_virtual_clock(int socket) { connect_to_driver(socket); }

__attribute__((constructor)) static void begin(void)
{
    const char *socket = getenv("VIRTUAL_CLOCK");
    look_up();
    if (socket)
        connect_to_driver(atoi(socket));
}
