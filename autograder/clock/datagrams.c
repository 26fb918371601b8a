/*
 * Queue datagrams, and send them when every process waits.
 *
 * Normally, a datagram reaches its reader while the sender still computes, so the speed of the two
 * decides what happens next. This library posts a datagram: it stores the datagram in a queue. A process
 * with posted datagrams is due at once: when every process waits, the driver wakes it as if its deadline
 * had passed, and it sends a portion. The readers handle this portion and all its consequences before the
 * next portion is sent. So discovery between two programs is deterministic, and no reader's buffer
 * overflows.
 */
#include "library.h"

#include <limits.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>

#define PORTION 64          /* datagrams; a reader's buffer holds 90 datagrams of 1 kB ... */
#define PORTION_BYTES 48000 /* ... and at most 200 kB */
#define MOST 1024           /* posted datagrams; a thread that posts more waits for the next portion */
#define LONGEST 65507       /* maximum size of a datagram [bytes] */

struct letter {
    struct letter *next;
    int fd, flags;
    socklen_t length; /* length of the address */
    struct sockaddr_in6 to; /* or a sockaddr_in, which is smaller */
    size_t size;
    char bytes[];
};

static struct letter *first, **end = &first;
static int posted;

bool has_post(void) { return first != NULL; }

void forget_post(void)
{
    first = NULL; /* the parent sends these datagrams; the child does not free their memory */
    end = &first;
    posted = 0;
}

void send_portion(void)
{
    size_t bytes = 0;
    for (int sent = 0; first && sent < PORTION && bytes < PORTION_BYTES; sent++) {
        struct letter *letter = first;
        REAL(sendto)(letter->fd, letter->bytes, letter->size, letter->flags,
                     (struct sockaddr *)&letter->to, letter->length);
        first = letter->next;
        bytes += letter->size;
        posted--;
        free(letter);
    }
    if (!first)
        end = &first;
    wake_waiters(&posted, INT_MAX);
}

static bool is_posted(int fd)
{
    struct letter *letter = first;
    while (letter && fd >= 0 && letter->fd != fd)
        letter = letter->next;
    return letter;
}

/* Wait until all datagrams posted on a socket are sent, or all datagrams if `fd` is negative. The caller
 * is about to close the socket or end the process. */
void wait_for_post(int fd)
{
    struct thread *thread = self();
    if (!thread)
        return;
    lock();
    while (is_posted(fd))
        wait_on(thread, &posted, NEVER);
    unlock();
}

static bool is_datagram_socket(int fd)
{
    int type = 0;
    socklen_t size = sizeof type;
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}

static struct letter *write_letter(int fd, const struct msghdr *message, int flags)
{
    size_t size = 0;
    for (size_t i = 0; i < message->msg_iovlen; i++)
        size += message->msg_iov[i].iov_len;
    struct letter *letter = size <= LONGEST ? malloc(sizeof *letter + size) : NULL;
    if (!letter)
        return NULL;
    *letter = (struct letter){.fd = fd, .flags = flags, .length = message->msg_namelen};
    memcpy(&letter->to, message->msg_name, message->msg_namelen);
    for (size_t i = 0; i < message->msg_iovlen; i++) {
        const struct iovec *part = &message->msg_iov[i];
        memcpy(letter->bytes + letter->size, part->iov_base, part->iov_len);
        letter->size += part->iov_len;
    }
    return letter;
}

/* Post a message if it is a datagram to an Internet address; return its size, or -1 if it is not. */
ssize_t post(int fd, const struct msghdr *message, int flags)
{
    struct thread *thread = self();
    const struct sockaddr *to = message->msg_name;
    if (!thread || !to || message->msg_controllen || message->msg_namelen > sizeof(struct sockaddr_in6) ||
        (to->sa_family != AF_INET && to->sa_family != AF_INET6) || !is_datagram_socket(fd))
        return -1;
    struct letter *letter = write_letter(fd, message, flags);
    if (!letter)
        return -1;
    ssize_t size = (ssize_t)letter->size;
    lock();
    while (posted >= MOST)
        wait_on(thread, &posted, NEVER);
    *end = letter;
    end = &letter->next;
    posted++;
    unlock();
    return size;
}

/* -- the end of the process -- */

__attribute__((destructor)) static void at_exit(void) { wait_for_post(-1); }

EXPORT void _exit(int status)
{
    wait_for_post(-1);
    REAL(_exit)(status);
    __builtin_unreachable();
}
