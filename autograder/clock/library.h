/*
 * Declarations that the files of the library share.
 *
 * threads.c      the threads of this process: waiting and waking
 * connection.c   joining the clock, and the helper thread that serves the driver
 * waits.c        waits for other threads, and sleeps
 * descriptors.c  waits for descriptors
 * datagrams.c    sending datagrams in a fixed order
 * timers.c       alarms and timerfds
 * clocks.c       reading the clock, and loops that poll the clock
 * processes.c    child processes and waits for their end
 * processors.c   how many processors the program sees
 */
#ifndef LIBRARY_H
#define LIBRARY_H

#define _GNU_SOURCE
#include "protocol.h"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
#define MAX_THREADS 256
#define MAX_FDS 1024
#define MILLISECOND (SECOND / 1000)

/* The functions of the C library that this library replaces. All are looked up at the start, because a
 * later look-up could wait for the loader's lock, and this library cannot see that wait. */
#define FUNCTIONS(X) \
    X(_exit) X(accept) X(accept4) X(clock_gettime) X(clock_nanosleep) X(close) X(close_range) X(epoll_wait) \
    X(execve) X(execvpe) X(fork) X(gettimeofday) X(pause) X(poll) X(posix_spawn) X(posix_spawnp) \
    X(ppoll) X(pselect) X(pthread_clockjoin_np) X(pthread_create) X(pthread_join) \
    X(pthread_mutex_lock) X(pthread_mutex_trylock) X(pthread_mutex_unlock) \
    X(pthread_rwlock_tryrdlock) X(pthread_rwlock_trywrlock) X(pthread_rwlock_unlock) X(read) X(recv) \
    X(recvfrom) X(recvmsg) X(sched_getaffinity) X(sched_setaffinity) X(sem_clockwait) X(sem_init) \
    X(sem_open) X(sem_post) X(sem_trywait) X(sem_wait) X(send) X(sendmsg) X(sendto) X(setitimer) \
    X(sigsuspend) X(sigtimedwait) X(syscall) X(timerfd_create) X(timerfd_gettime) \
    X(timerfd_settime) X(wait4) X(waitid) X(write)

struct functions {
#define X(name) __typeof__(&name) name;
    FUNCTIONS(X)
#undef X
};
extern struct functions functions;
void look_up(void);
/* Look up the functions if a constructor of another library runs before that of this library. */
#define REAL(name) (functions.name ? functions.name : (look_up(), functions.name))

/* How a wait ended; BY_ITSELF if data or a signal arrived. */
enum why { BY_ITSELF, WOKEN, TIMED_OUT, INTERRUPTED };

struct thread {
    bool used;
    pthread_t id;
    void *(*start)(void *);
    void *argument;
    /* State of a wait: */
    bool waiting, in_poll;
    bool polling;          /* it waits only because it reads the clock in a loop, see clocks.c */
    const void *on;        /* the address that it waits on */
    int64_t deadline;      /* when to wake it, or NEVER */
    uint64_t place;        /* its position in the queue of the address */
    _Atomic uint32_t word; /* 0 until it may continue; it sleeps in a futex on this word */
    int eventfd;           /* wakes it if it sleeps in poll; -1 if not created yet */
    enum why why;
    struct thread *held_by; /* the thread that woke it and releases it later, see `receiving` */
    /* Whether it has received a datagram. Threads that it wakes then continue only after it has handled
     * all datagrams that have arrived. Otherwise, the speed of the threads would decide how many messages
     * a short queue loses. */
    bool receiving;
    /* State for clocks.c: */
    int reads, empty_waits, steps;
    uint64_t work;         /* the value of `work` in threads.c when the polling sleep began */
};

/* threads.c. The caller of a function marked L holds the lock. */
extern _Atomic bool active;         /* whether this process is on the clock */
extern _Atomic int interpreter_wanted; /* threads that wait for the interpreter lock */
struct thread *self(void);          /* NULL if the calling thread is not on the clock */
void leave_clock(void);
void lock(void);
void unlock(void);
enum why wait_on(struct thread *me, const void *on, int64_t deadline);         /* L */
enum why wait_for_interpreter(struct thread *me, const void *on, int64_t limit); /* L */
void begin_wait(struct thread *me, const void *on, int64_t deadline);          /* L */
enum why end_wait(struct thread *me);                                          /* L */
int wake_waiters(const void *on, int most);                                    /* L */
void sleep_polling(struct thread *me, int64_t deadline);                       /* L */
void let_go(struct thread *me);                                                /* L */
void begin_receiving(void);
void end_receiving(void);
void wait_for_portion(void);
void interrupt_main(int signal);                                               /* L */
void wake_due(void);                                                           /* L */
void begin_threads(struct process_page *page, const struct time_page *timing, int is_idle);
int64_t now(void);
int64_t realtime(void);
int64_t deadline_in(int64_t nanoseconds);
int64_t deadline_at(clockid_t clock, const struct timespec *at);
int64_t with_slack(int64_t deadline);

/* connection.c */
extern int in_flight;   /* epoll set of the descriptors that threads wait for; the driver checks it */
extern int our_socket;  /* connected to the driver */
void begin_again_in_child(int socket);
bool is_ours(int fd);
int keep_open(int fd);  /* move a descriptor to a high number, and prevent the program from closing it */

/* descriptors.c */
int poll_until(struct pollfd *fds, nfds_t count, int64_t deadline);
void forget_descriptors(void);

/* datagrams.c */
ssize_t post(int fd, const struct msghdr *message, int flags);
bool has_post(void);             /* L */
void send_portion(void);         /* L */
void wait_for_post(int fd);
void forget_post(void);

/* timers.c */
int64_t first_timer(void); /* L */
void fire_timer(void);     /* L */
void forget_timer(int fd);
void forget_timers(void);

/* waits.c */
extern bool locks_read_the_clock; /* whether this CPython reads the clock for each lock that it takes */

/* clocks.c */
void waited_for_nothing(void);
void took_a_lock(void);
void sent_something(void);

#endif
