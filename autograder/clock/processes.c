/*
 * Child processes on the same clock, and waits for their end.
 *
 * The library requests a child's place from the driver before it creates the child, so that time cannot
 * pass in between. A program that a child executes finds its socket in the variable VIRTUAL_CLOCK.
 */
#include "library.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>

#define MAX_CHILDREN 128
#define KILLED_MS 1000
#define OTHER_MS 2

static pid_t children[MAX_CHILDREN];

/* Replace the entry `before` by `now`; each is a child's process id, or 0 for a free entry. */
static void change_child(pid_t before, pid_t now)
{
    int i = 0;
    lock();
    while (i < MAX_CHILDREN && children[i] != before)
        i++;
    if (i < MAX_CHILDREN)
        children[i] = now;
    unlock();
}

static void remember_child(pid_t pid) { change_child(0, pid); }
static void forget_child(pid_t pid) { change_child(pid, 0); }

/*
 * Request a place for a child; return the child's socket, or -1 on failure. The driver reads the child's
 * process id from the credentials of its first message. The child may send that message before the driver
 * has read the request, so SO_PASSCRED is set here.
 */
static int order_place(void)
{
    int pair[2], on = 1;
    char byte = ADOPT;
    union {
        char bytes[CMSG_SPACE(sizeof(int))];
        struct cmsghdr aligned;
    } control = {0};
    struct iovec data = {&byte, 1};
    struct msghdr message = {.msg_iov = &data, .msg_iovlen = 1, .msg_control = control.bytes,
                             .msg_controllen = sizeof control.bytes};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) < 0)
        return -1;
    setsockopt(pair[1], SOL_SOCKET, SO_PASSCRED, &on, sizeof on);
    struct cmsghdr *header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int));
    memcpy(CMSG_DATA(header), &pair[1], sizeof(int));
    ssize_t sent = sendmsg(our_socket, &message, MSG_NOSIGNAL);
    REAL(close)(pair[1]);
    if (sent == 1) {
        int high = fcntl(pair[0], F_DUPFD, 120);
        if (high >= 0) {
            REAL(close)(pair[0]);
            return high;
        }
    }
    REAL(close)(pair[0]);
    return -1;
}

EXPORT pid_t fork(void)
{
    if (!self())
        return REAL(fork)();
    int socket = order_place();
    pid_t pid = REAL(fork)();
    if (pid == 0) {
        memset(children, 0, sizeof children);
        begin_again_in_child(socket);
        return 0;
    }
    int error = errno;
    REAL(close)(socket);
    if (pid > 0)
        remember_child(pid);
    errno = error;
    return pid;
}

/* Use fork, which allows everything that a child of vfork may do. */
EXPORT pid_t vfork(void) { return fork(); }

/* -- new images -- */

/* Return the environment with the library and a socket added; `room` stores the new strings. */
static char **with_clock(char *const *environment, int socket, char **list, size_t size, char *room)
{
    const char *library = getenv("LD_PRELOAD");
    size_t n = 0;
    bool preloaded = false;
    for (; environment && *environment && n + 3 < size; environment++) {
        if (strncmp(*environment, "VIRTUAL_CLOCK=", 14) == 0)
            continue;
        preloaded |= strncmp(*environment, "LD_PRELOAD=", 11) == 0;
        list[n++] = *environment;
    }
    sprintf(room, "VIRTUAL_CLOCK=%d", socket);
    list[n++] = room;
    if (!preloaded && library) {
        snprintf(room + 32, PATH_MAX, "LD_PRELOAD=%s", library);
        list[n++] = room + 32;
    }
    list[n] = NULL;
    return list;
}

#define WITH_CLOCK(environment, socket) \
    char *list[1024], room[PATH_MAX + 32]; \
    char **changed = with_clock(environment, socket, list, 1024, room)

EXPORT int execve(const char *path, char *const arguments[], char *const environment[])
{
    if (!active)
        return REAL(execve)(path, arguments, environment);
    WITH_CLOCK(environment, our_socket);
    wait_for_post(-1);
    fcntl(our_socket, F_SETFD, 0);
    return REAL(execve)(path, arguments, changed);
}

EXPORT int execvpe(const char *file, char *const arguments[], char *const environment[])
{
    if (!active)
        return REAL(execvpe)(file, arguments, environment);
    WITH_CLOCK(environment, our_socket);
    wait_for_post(-1);
    fcntl(our_socket, F_SETFD, 0);
    return REAL(execvpe)(file, arguments, changed);
}

EXPORT int execv(const char *path, char *const arguments[]) { return execve(path, arguments, environ); }

EXPORT int execvp(const char *file, char *const arguments[])
{
    return execvpe(file, arguments, environ);
}

typedef __typeof__(posix_spawn) spawn_function;

static int spawn(spawn_function *really, pid_t *pid, const char *path,
                 const posix_spawn_file_actions_t *actions, const posix_spawnattr_t *attributes,
                 char *const arguments[], char *const environment[])
{
    if (!self())
        return really(pid, path, actions, attributes, arguments, environment);
    pid_t child;
    int socket = order_place();
    WITH_CLOCK(environment, socket);
    int result = really(&child, path, actions, attributes, arguments, changed);
    REAL(close)(socket);
    if (result == 0) {
        remember_child(child);
        if (pid)
            *pid = child;
    }
    return result;
}

/* The two functions differ only in how they find the program. */
#define SPAWN(name) \
    EXPORT int name(pid_t *pid, const char *path, const posix_spawn_file_actions_t *actions, \
                    const posix_spawnattr_t *attributes, char *const arguments[], \
                    char *const environment[]) \
    { \
        return spawn(REAL(name), pid, path, actions, attributes, arguments, environment); \
    }
SPAWN(posix_spawn)
SPAWN(posix_spawnp)

/* Do nothing: this action would close the child's socket. Other descriptors of Python close on exec. */
EXPORT int posix_spawn_file_actions_addclosefrom_np(posix_spawn_file_actions_t *actions, int from)
{
    (void)actions;
    (void)from;
    return 0;
}

/* -- waits for the end of a child -- */

static int open_child(pid_t pid) { return (int)REAL(syscall)(SYS_pidfd_open, pid, 0); }

/* Open a pidfd for a child, or for all children if `pid` is not positive, to poll for its end. Return
 * the number of pidfds. */
static nfds_t open_children(pid_t pid, struct pollfd fds[MAX_CHILDREN])
{
    nfds_t count = 0;
    lock();
    for (int i = 0; i < MAX_CHILDREN; i++)
        if (children[i] && (pid <= 0 || children[i] == pid) &&
            (fds[count].fd = open_child(children[i])) >= 0)
            fds[count++].events = POLLIN;
    unlock();
    return count;
}

static void close_children(const struct pollfd *fds, nfds_t count)
{
    for (nfds_t i = 0; i < count; i++)
        REAL(close)(fds[i].fd);
}

/* Wait until a child may have ended; any child if `pid` is not positive. */
static void wait_for_child(pid_t pid)
{
    struct pollfd fds[MAX_CHILDREN];
    nfds_t count = open_children(pid, fds);
    if (count)
        poll_until(fds, count, NEVER);
    close_children(fds, count);
}

EXPORT pid_t wait4(pid_t pid, int *status, int options, struct rusage *usage)
{
    if (self() && !(options & WNOHANG)) {
        pid_t found = REAL(wait4)(pid, status, options | WNOHANG, usage);
        if (found == 0)
            wait_for_child(pid);
        else if (found > 0)
            forget_child(found);
        if (found != 0)
            return found;
    }
    pid_t found = REAL(wait4)(pid, status, options, usage);
    if (found > 0)
        forget_child(found);
    return found;
}

EXPORT pid_t wait3(int *status, int options, struct rusage *usage)
{
    return wait4(-1, status, options, usage);
}

EXPORT pid_t waitpid(pid_t pid, int *status, int options)
{
    return wait4(pid, status, options, NULL);
}

EXPORT pid_t wait(int *status) { return wait4(-1, status, 0, NULL); }

EXPORT int waitid(idtype_t type, id_t id, siginfo_t *info, int options)
{
    siginfo_t found = {0};
    if (self() && !(options & WNOHANG) &&
        REAL(waitid)(type, id, &found, options | WNOHANG | WNOWAIT) == 0 && !found.si_pid)
        wait_for_child(type == P_PID ? (pid_t)id : -1);
    return REAL(waitid)(type, id, info, options);
}

EXPORT int system(const char *command)
{
    int status = -1;
    if (!command)
        return 1;
    pid_t pid = fork();
    if (pid == 0) {
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    return pid < 0 ? -1 : status;
}

EXPORT int execl(const char *path, const char *first, ...)
{
    char *arguments[256] = {(char *)first};
    va_list more;
    va_start(more, first);
    for (int i = 1; i < 255 && arguments[i - 1]; i++)
        arguments[i] = va_arg(more, char *);
    va_end(more);
    return execve(path, arguments, environ);
}

/*
 * A signal may reach its target only after kill() has returned, and until then the target seems to wait.
 * So the sender waits in real time: up to 1 s for the end of a process that it kills, and up to 2 ms
 * after other signals.
 */
EXPORT int kill(pid_t pid, int signal)
{
    if (pid == getpid())
        wait_for_post(-1);
    int result = (int)REAL(syscall)(SYS_kill, pid, signal);
    int fd = result == 0 && signal && pid > 0 && pid != getpid() && self() ? open_child(pid) : -1;
    if (fd >= 0) {
        struct pollfd one = {.fd = fd, .events = POLLIN};
        REAL(poll)(&one, 1, signal == SIGKILL ? KILLED_MS : OTHER_MS);
        REAL(close)(fd);
    }
    return result;
}

/* -- waits for a signal; they also wait for children, because the end of a child sends SIGCHLD -- */

EXPORT int sigsuspend(const sigset_t *mask)
{
    sigset_t before;
    if (!self())
        return REAL(sigsuspend)(mask);
    pthread_sigmask(SIG_SETMASK, mask, &before);
    struct pollfd fds[MAX_CHILDREN];
    nfds_t count = open_children(-1, fds);
    poll_until(fds, count, NEVER);
    close_children(fds, count);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = EINTR;
    return -1;
}

/* Wait with a signalfd, which can be polled for blocked signals. */
EXPORT int sigtimedwait(const sigset_t *set, siginfo_t *info, const struct timespec *timeout)
{
    if (!self())
        return REAL(sigtimedwait)(set, info, timeout);
    struct timespec none = {0, 0};
    struct pollfd one = {.fd = signalfd(-1, set, SFD_CLOEXEC), .events = POLLIN};
    int64_t deadline = timeout ? deadline_in(deadline_at(CLOCK_MONOTONIC, timeout)) : NEVER;
    int result = poll_until(&one, 1, deadline);
    close(one.fd);
    return result < 0 ? -1 : REAL(sigtimedwait)(set, info, &none);
}

EXPORT int sigwaitinfo(const sigset_t *set, siginfo_t *info) { return sigtimedwait(set, info, NULL); }

EXPORT int sigwait(const sigset_t *set, int *signal)
{
    int result;
    while ((result = sigtimedwait(set, NULL, NULL)) < 0 && errno == EINTR)
        ;
    if (result < 0)
        return errno;
    *signal = result;
    return 0;
}

EXPORT int pause(void)
{
    if (!self())
        return REAL(pause)();
    poll_until(NULL, 0, NEVER);
    errno = EINTR;
    return -1;
}
