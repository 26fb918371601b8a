/*
 * Programs of many threads, for test_races.py: `races STYLE SOCKET PORT`. SOCKET is a bound UDP socket,
 * PORT that of the other process. They are compiled with ThreadSanitizer, like the library that is loaded
 * into them. A program ends with code 1 if a time is wrong.
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define THREADS 12
#define ROUNDS 20
#define MS INT64_C(1000000)
#define SECOND (1000 * MS)
#define EXPECT(fact) \
    ((fact) ? (void)0 : (fprintf(stderr, "line %d: not so: %s\n", __LINE__, #fact), _exit(1)))

static int64_t began;

static int64_t clock_ns(clockid_t clock)
{
    struct timespec at;
    clock_gettime(clock, &at);
    return at.tv_sec * SECOND + at.tv_nsec;
}

static int64_t elapsed(void) { return clock_ns(CLOCK_MONOTONIC) - began; }

static struct timespec of(int64_t time) { return (struct timespec){time / SECOND, time % SECOND}; }

static void doze(int64_t time)
{
    struct timespec length = of(time);
    nanosleep(&length, NULL);
}

static void *(*work_of_all)(void *);
static atomic_int arrived;

/* Begin when all are there. A relaxed counter orders nothing, so it hides no race. */
static void *at_once(void *number)
{
    atomic_fetch_add_explicit(&arrived, 1, memory_order_relaxed);
    while (atomic_load_explicit(&arrived, memory_order_relaxed) < THREADS)
        sched_yield();
    return work_of_all(number);
}

/* Run a function in many threads, each with its number, and wait for their end. */
static void together(void *(*work)(void *))
{
    pthread_t ids[THREADS];
    work_of_all = work;
    for (intptr_t i = 0; i < THREADS; i++)
        EXPECT(pthread_create(&ids[i], NULL, at_once, (void *)i) == 0);
    for (int i = 0; i < THREADS; i++)
        EXPECT(pthread_join(ids[i], NULL) == 0);
}

/* -- sleeps -- */

static void *sleeper(void *number)
{
    int64_t length = ((intptr_t)number + 1) * MS, start = elapsed();
    for (int i = 1; i <= ROUNDS; i++) {
        doze(length);
        EXPECT(elapsed() == start + i * length);
    }
    return NULL;
}

static void sleeps(void)
{
    together(sleeper);
    EXPECT(elapsed() == ROUNDS * THREADS * MS);
}

/* Threads that start threads, and end in any order. */
static void *parent(void *depth)
{
    pthread_t children[2];
    for (int i = 0; depth && i < 2; i++)
        pthread_create(&children[i], NULL, parent, (char *)depth - 1);
    doze(MS);
    for (int i = 0; depth && i < 2; i++)
        pthread_join(children[i], NULL);
    return NULL;
}

static void generations(void)
{
    parent((void *)5);
    EXPECT(elapsed() == MS);
}

/* -- conditions, mutexes, read-write locks, semaphores -- */

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int items, taken;

static void *consumer(void *number)
{
    pthread_mutex_lock(&mutex);
    while (taken < ROUNDS * THREADS) {
        struct timespec at = of(clock_ns(CLOCK_REALTIME) + ((intptr_t)number + 1) * 3 * MS);
        if (items > 0)
            items--, taken++;
        else if (number)
            pthread_cond_timedwait(&changed, &mutex, &at);
        else
            pthread_cond_wait(&changed, &mutex);
    }
    pthread_cond_broadcast(&changed);
    pthread_mutex_unlock(&mutex);
    return NULL;
}

static void *producer(void *unused)
{
    for (int i = 0; i < ROUNDS * THREADS; i++) {
        doze(MS);
        pthread_mutex_lock(&mutex);
        items++;
        pthread_mutex_unlock(&mutex);
        pthread_cond_signal(&changed);
    }
    return unused;
}

static void conditions(void)
{
    pthread_t id;
    pthread_create(&id, NULL, producer, NULL);
    together(consumer);
    pthread_join(id, NULL);
    EXPECT(taken == ROUNDS * THREADS && elapsed() == ROUNDS * THREADS * MS);
}

static pthread_rwlock_t many = PTHREAD_RWLOCK_INITIALIZER;
static int guarded, shared;

static void *contender(void *number)
{
    for (int i = 0; i < ROUNDS; i++) {
        struct timespec at = of(clock_ns(CLOCK_REALTIME) + MS);
        if (pthread_mutex_timedlock(&mutex, &at) == 0) {
            guarded++;
            doze(i % 3 * MS);
            pthread_mutex_unlock(&mutex);
        }
        if ((intptr_t)number % 3)
            pthread_rwlock_rdlock(&many), doze(shared % 2 * MS);
        else
            pthread_rwlock_wrlock(&many), shared++;
        pthread_rwlock_unlock(&many);
    }
    return NULL;
}

static void locks(void)
{
    together(contender);
    EXPECT(guarded >= ROUNDS && shared == ROUNDS * THREADS / 3);
}

static sem_t tokens;

static void *token_user(void *number)
{
    sem_t *own = mmap(NULL, sizeof *own, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    sem_init(own, 1, 0); /* as multiprocessing does */
    for (int i = 0; i < ROUNDS; i++) {
        struct timespec at = of(clock_ns(CLOCK_REALTIME) + MS);
        EXPECT(sem_timedwait(own, &at) == -1 && errno == ETIMEDOUT);
        at = of(clock_ns(CLOCK_REALTIME) + 2 * MS);
        if (sem_timedwait(&tokens, &at) == 0) {
            doze((intptr_t)number % 2 * MS);
            sem_post(&tokens);
        }
    }
    return NULL;
}

static void semaphores(void)
{
    sem_init(&tokens, 0, 2);
    together(token_user);
}

/* -- clocks and timers -- */

static void *poller(void *number)
{
    struct timespec at[4];
    clock_gettime(CLOCK_BOOTTIME, &at[0]); /* from several places in the code */
    clock_gettime(CLOCK_MONOTONIC_RAW, &at[1]);
    clock_gettime(CLOCK_REALTIME_COARSE, &at[2]);
    clock_gettime(CLOCK_REALTIME, &at[3]);
    EXPECT(at[0].tv_sec == at[1].tv_sec && at[2].tv_sec == at[3].tv_sec);
    int64_t until = ((intptr_t)number % 3 + 1) * 20 * MS;
    while (elapsed() < until)
        ;
    EXPECT(elapsed() < until + 10 * MS);
    return NULL;
}

static void polls_of_the_clock(void) { together(poller); }

static void *timer_user(void *number)
{
    if ((intptr_t)number > 9)
        return NULL;
    int64_t period = ((intptr_t)number + 1) * MS, start = elapsed();
    struct itimerspec every = {of(period), of(period)}, left;
    int timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
    for (int i = 0; i < 1000; i++)
        EXPECT(timerfd_settime(timer, 0, &every, NULL) == 0);
    for (int i = 1; i <= ROUNDS; i++) {
        uint64_t times;
        EXPECT(read(timer, &times, sizeof times) == sizeof times && times == 1);
        EXPECT(elapsed() == start + i * period);
        timerfd_gettime(timer, &left);
    }
    close(timer);
    return NULL;
}

static void timers(void) { together(timer_user); }

/* -- descriptors -- */

static int ring[THREADS];

static void *runner(void *number)
{
    int own = ring[(intptr_t)number], next = ring[((intptr_t)number + 1) % THREADS];
    struct pollfd one = {.fd = own, .events = POLLIN};
    for (int i = 0; i < ROUNDS; i++) {
        eventfd_t value;
        fd_set set;
        FD_ZERO(&set);
        FD_SET(own, &set);
        while (poll(&one, 1, 2) == 0)
            ;
        EXPECT(select(own + 1, &set, NULL, NULL, NULL) == 1);
        EXPECT(read(own, &value, sizeof value) == sizeof value);
        doze(MS);
        value = 1;
        EXPECT(write(next, &value, sizeof value) == sizeof value);
    }
    return NULL;
}

static void descriptors(void)
{
    for (int i = 0; i < THREADS; i++)
        ring[i] = eventfd(i == 0, 0);
    together(runner);
    EXPECT(elapsed() == ROUNDS * THREADS * MS);
}

static int udp;
static struct sockaddr_in other = {.sin_family = AF_INET};
static atomic_int heard;

static void *listener(void *unused)
{
    char bytes[8];
    while (recv(udp, bytes, sizeof bytes, 0) == sizeof bytes)
        atomic_fetch_add(&heard, 1);
    return unused;
}

static void *speaker(void *number)
{
    for (int i = 0; i < ROUNDS; i++) {
        for (int k = 0; k < (intptr_t)number; k++)
            EXPECT(sendto(udp, "datagram", 8, 0, (struct sockaddr *)&other, sizeof other) == 8);
        doze(MS);
    }
    return NULL;
}

/* Two processes that speak and listen. */
static void datagrams(void)
{
    pthread_t ids[2];
    for (int i = 0; i < 2; i++)
        pthread_create(&ids[i], NULL, listener, NULL);
    together(speaker);
    EXPECT(elapsed() == ROUNDS * MS && heard == ROUNDS * THREADS * (THREADS - 1) / 2);
    shutdown(udp, SHUT_RD);
    for (int i = 0; i < 2; i++)
        pthread_join(ids[i], NULL);
}

/* -- processes -- */

static void nap(void) { doze(MS); }

/* Children of this very program: the sanitizer cannot be loaded into others. */
static void *spawner(void *unused)
{
    char *words[] = {"races", "nap", NULL};
    pid_t child;
    int status;
    EXPECT(posix_spawn(&child, "/proc/self/exe", NULL, NULL, words, environ) == 0);
    EXPECT(waitpid(child, &status, 0) == child && status == 0);
    return unused;
}

static void children(void)
{
    together(spawner);
    EXPECT(elapsed() == MS);
}

static void *forker(void *number)
{
    int status;
    pid_t child = fork();
    if (child == 0) {
        doze(((intptr_t)number + 1) * MS);
        _exit(0);
    }
    EXPECT(waitpid(child, &status, 0) == child && status == 0);
    return NULL;
}

static void forks(void)
{
    together(forker);
    EXPECT(elapsed() == THREADS * MS);
}

int main(int count, char **words)
{
    static const struct { const char *name; void (*run)(void); } styles[] = {
        {"sleeps", sleeps}, {"generations", generations}, {"conditions", conditions},
        {"locks", locks}, {"semaphores", semaphores}, {"polls", polls_of_the_clock},
        {"timers", timers}, {"descriptors", descriptors}, {"datagrams", datagrams},
        {"nap", nap}, {"children", children}, {"forks", forks},
    };
    began = clock_ns(CLOCK_MONOTONIC);
    if (count == 4) {
        udp = atoi(words[2]);
        other.sin_port = htons((uint16_t)atoi(words[3]));
        other.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    for (size_t i = 0; count > 1 && i < sizeof styles / sizeof *styles; i++)
        if (strcmp(words[1], styles[i].name) == 0) {
            styles[i].run();
            return 0;
        }
    return 2;
}
