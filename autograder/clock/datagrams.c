/*
 * Datagrams leave when everything waits.
 *
 * In real life a datagram is with its reader while its sender still computes, so which of the two is
 * quicker decides what happens next. Here it is posted. A process with post is due at once: when every
 * process waits, the driver wakes it as if its deadline had come, and a portion leaves. The readers have
 * handled it, and all that follows from it, before the next portion leaves. So two programs that meet over
 * the network always meet in the same way, and no reader's buffer overflows.
 */
#include "library.h"

#include <limits.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>

#define PORTION 64          /* datagrams; a reader's buffer holds 90 of 1 kB ... */
#define PORTION_BYTES 48000 /* ... and 200 kB */
#define MOST 1024           /* a thread that posts more waits until a portion has left */
#define LONGEST 65507       /* of a datagram [bytes] */

struct letter {
    struct letter *next;
    int fd, flags;
    socklen_t length; /* of the address */
    struct sockaddr_in6 to; /* or a sockaddr_in, which is smaller */
    size_t size;
    char bytes[];
};

static struct letter *first, **end = &first;
static int posted;

bool has_post(void) { return first != NULL; }

void forget_post(void)
{
    first = NULL; /* they are the parent's; their memory is of no account */
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

/* Wait until nothing is posted: what follows ends the socket, or the process if it is negative. */
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

/* Post a message if it is a datagram for an Internet address; return its size, -1 if it is none. */
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

/* -- the ends of a process -- */

__attribute__((destructor)) static void at_exit(void) { wait_for_post(-1); }

EXPORT void _exit(int status)
{
    wait_for_post(-1);
    REAL(_exit)(status);
    __builtin_unreachable();
}
