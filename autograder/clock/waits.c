/*
 * Waits for other threads (conditions, mutexes, read-write locks, semaphores, futexes), and sleeps.
 *
 * This library implements conditions and futexes as queues, identified by their address. The C library
 * still implements mutexes, read-write locks and semaphores: a thread tries to take the lock and, if this
 * fails, waits for the next release.
 */
#include "library.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <link.h>
#include <linux/futex.h>
#include <stdarg.h>
#include <string.h>
#include <sys/syscall.h>

#define LOOK_AGAIN MILLISECOND /* interval for checking a semaphore that processes share */

/* -- locks of the C library -- */

static _Atomic int contended; /* number of threads that wait for such a lock */

/* Try to take a lock until a try succeeds or the deadline has passed. `attempt` returns 0, EBUSY or
 * another error. */
static int try_until(int (*attempt)(void *), void *object, int64_t deadline)
{
    int result = attempt(object);
    struct thread *thread;
    if (result != EBUSY || !(thread = self()))
        return result;
    lock();
    /* Count before the next try, so that a release after a failed try sees the count. */
    atomic_fetch_add(&contended, 1);
    while ((result = attempt(object)) == EBUSY)
        if (wait_on(thread, object, deadline) == TIMED_OUT) {
            result = attempt(object) == 0 ? 0 : ETIMEDOUT;
            break;
        }
    atomic_fetch_sub(&contended, 1);
    unlock();
    return result;
}

static void released(void *object, int most)
{
    atomic_thread_fence(memory_order_seq_cst);
    if (active && atomic_load(&contended) > 0 && self()) {
        lock();
        wake_waiters(object, most);
        unlock();
    }
}

static int try_mutex(void *mutex) { return REAL(pthread_mutex_trylock)(mutex); }
static int try_read(void *rwlock) { return REAL(pthread_rwlock_tryrdlock)(rwlock); }
static int try_write(void *rwlock) { return REAL(pthread_rwlock_trywrlock)(rwlock); }

EXPORT int pthread_mutex_lock(pthread_mutex_t *mutex)
{
    return active ? try_until(try_mutex, mutex, NEVER) : REAL(pthread_mutex_lock)(mutex);
}

EXPORT int pthread_mutex_clocklock(pthread_mutex_t *mutex, clockid_t clock,
                                   const struct timespec *at)
{
    return try_until(try_mutex, mutex, active ? deadline_at(clock, at) : NEVER);
}

EXPORT int pthread_mutex_timedlock(pthread_mutex_t *mutex, const struct timespec *at)
{
    return pthread_mutex_clocklock(mutex, CLOCK_REALTIME, at);
}

EXPORT int pthread_mutex_unlock(pthread_mutex_t *mutex)
{
    int result = REAL(pthread_mutex_unlock)(mutex);
    released(mutex, 1);
    return result;
}

EXPORT int pthread_rwlock_rdlock(pthread_rwlock_t *rwlock)
{
    return try_until(try_read, rwlock, NEVER);
}

EXPORT int pthread_rwlock_wrlock(pthread_rwlock_t *rwlock)
{
    return try_until(try_write, rwlock, NEVER);
}

EXPORT int pthread_rwlock_unlock(pthread_rwlock_t *rwlock)
{
    int result = REAL(pthread_rwlock_unlock)(rwlock);
    released(rwlock, INT_MAX);
    return result;
}

/* -- semaphores -- */

/* Semaphores that processes share. They are checked regularly, because this library does not see when
 * another process releases them. */
static const void *shared[64];
static int shared_count;

static bool is_shared(const void *semaphore)
{
    for (int i = 0; i < shared_count; i++)
        if (shared[i] == semaphore)
            return true;
    return false;
}

static void remember_shared(const void *semaphore)
{
    if (!active || !semaphore)
        return;
    lock();
    if (!is_shared(semaphore) && shared_count < 64)
        shared[shared_count++] = semaphore;
    unlock();
}

EXPORT int sem_init(sem_t *semaphore, int of_processes, unsigned value)
{
    if (of_processes)
        remember_shared(semaphore);
    return REAL(sem_init)(semaphore, of_processes, value);
}

EXPORT sem_t *sem_open(const char *name, int flags, ...)
{
    va_list more;
    va_start(more, flags);
    mode_t mode = va_arg(more, mode_t);
    unsigned value = va_arg(more, unsigned);
    va_end(more);
    sem_t *semaphore = REAL(sem_open)(name, flags, mode, value);
    remember_shared(semaphore == SEM_FAILED ? NULL : semaphore);
    return semaphore;
}

EXPORT int sem_post(sem_t *semaphore)
{
    int result = REAL(sem_post)(semaphore);
    released(semaphore, 1);
    end_receiving(); /* this is a Python thread, whose locks are semaphores; its next work may be long */
    return result;
}

EXPORT int sem_trywait(sem_t *semaphore)
{
    int result = REAL(sem_trywait)(semaphore);
    if (result == 0)
        took_a_lock();
    return result;
}

static int wait_for_semaphore(sem_t *semaphore, int64_t deadline)
{
    struct thread *thread = self();
    int result, error = ETIMEDOUT;
    if (sem_trywait(semaphore) == 0)
        return 0;
    if (deadline <= now())
        waited_for_nothing();
    lock();
    atomic_fetch_add(&contended, 1);
    while ((result = REAL(sem_trywait)(semaphore)) != 0) {
        if (deadline <= now())
            break;
        int64_t until = deadline, look = deadline_in(LOOK_AGAIN);
        if (is_shared(semaphore) && look < until)
            until = look;
        enum why why = wait_on(thread, semaphore, until);
        if (why == INTERRUPTED || why == BY_ITSELF) {
            error = EINTR;
            result = REAL(sem_trywait)(semaphore);
            break;
        }
    }
    atomic_fetch_sub(&contended, 1);
    unlock();
    if (result != 0)
        errno = error;
    return result;
}

EXPORT int sem_wait(sem_t *semaphore)
{
    return self() ? wait_for_semaphore(semaphore, NEVER) : REAL(sem_wait)(semaphore);
}

EXPORT int sem_clockwait(sem_t *semaphore, clockid_t clock, const struct timespec *at)
{
    if (!self())
        return REAL(sem_clockwait)(semaphore, clock, at);
    return wait_for_semaphore(semaphore, deadline_at(clock, at));
}

EXPORT int sem_timedwait(sem_t *semaphore, const struct timespec *at)
{
    return sem_clockwait(semaphore, CLOCK_REALTIME, at);
}

/* -- conditions -- */

/*
 * CPython's interpreter lock is the only exception. A thread that wants the lock waits five milliseconds
 * and then requests it from its holder. This wait is in real time, because the holder computes and
 * virtual time stands still. The condition of the lock is inside the symbol _PyRuntime.
 */
static const char *interpreter, *interpreter_end;
bool locks_read_the_clock;

/* Return whether an object imports a symbol. In the symbol table, imported symbols come before those in
 * the hash table. */
static bool imports(const struct link_map *object, const char *name)
{
    const ElfW(Sym) *symbols = NULL;
    const char *names = NULL;
    const uint32_t *hash = NULL;
    for (const ElfW(Dyn) *entry = object->l_ld; entry->d_tag != DT_NULL; entry++) {
        const void *at = (const void *)entry->d_un.d_ptr;
        if (entry->d_tag == DT_SYMTAB)
            symbols = at;
        else if (entry->d_tag == DT_STRTAB)
            names = at;
        else if (entry->d_tag == DT_GNU_HASH)
            hash = at;
    }
    for (uint32_t i = 1; hash && i < hash[1]; i++)
        if (strcmp(names + symbols[i].st_name, name) == 0)
            return true;
    return false;
}

__attribute__((constructor)) static void find_interpreter(void)
{
    Dl_info where;
    const ElfW(Sym) *symbol = NULL;
    const struct link_map *object = NULL;
    void *runtime = dlsym(RTLD_DEFAULT, "_PyRuntime");
    if (!runtime || !dladdr1(runtime, &where, (void **)&symbol, RTLD_DL_SYMENT) || !symbol)
        return;
    interpreter = runtime;
    interpreter_end = interpreter + symbol->st_size;
    dladdr1(runtime, &where, (void **)&object, RTLD_DL_LINKMAP);
    /* CPython 3.11 or newer, built with a C library that has sem_clockwait. */
    locks_read_the_clock = dlsym(RTLD_DEFAULT, "Py_Version") && imports(object, "sem_clockwait");
}

static bool is_interpreter_lock(const void *condition)
{
    return (const char *)condition >= interpreter && (const char *)condition < interpreter_end;
}

#define ASK_HOLDER (SECOND / 10000) /* real time until the request; CPython itself waits 5 ms */

static int wait_for_condition(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t deadline)
{
    struct thread *thread = self();
    bool interpreter = deadline != NEVER && is_interpreter_lock(condition);
    enum why why;
    if (!thread)
        return 0; /* the thread is not on the clock: return like a spurious wake-up */
    if (deadline <= now() && !interpreter) {
        pthread_mutex_unlock(mutex);
        waited_for_nothing();
        pthread_mutex_lock(mutex);
        return ETIMEDOUT;
    }
    lock();
    REAL(pthread_mutex_unlock)(mutex);
    if (atomic_load(&contended) > 0)
        wake_waiters(mutex, 1);
    if (interpreter)
        why = wait_for_interpreter(thread, condition, ASK_HOLDER);
    else
        why = wait_on(thread, condition, deadline);
    unlock();
    pthread_mutex_lock(mutex);
    /* Return ETIMEDOUT even if the thread was woken, so that CPython requests the lock again at once. */
    return interpreter || why == TIMED_OUT ? ETIMEDOUT : 0;
}

EXPORT int pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex)
{
    return wait_for_condition(condition, mutex, NEVER);
}

EXPORT int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                                  clockid_t clock, const struct timespec *at)
{
    return wait_for_condition(condition, mutex, deadline_at(clock, at));
}

EXPORT int pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                                  const struct timespec *at)
{
    /* glibc stores the clock of a condition in bit 1 of a private word. */
    bool monotonic = condition->__data.__wrefs & 2;
    clockid_t clock = monotonic ? CLOCK_MONOTONIC : CLOCK_REALTIME;
    return wait_for_condition(condition, mutex, deadline_at(clock, at));
}

static int signal_condition(pthread_cond_t *condition, int most)
{
    if (self()) {
        lock();
        wake_waiters(condition, most);
        unlock();
    }
    return 0;
}

EXPORT int pthread_cond_signal(pthread_cond_t *condition) { return signal_condition(condition, 1); }

EXPORT int pthread_cond_broadcast(pthread_cond_t *condition)
{
    return signal_condition(condition, INT_MAX);
}

/* -- futexes, which C++ futures, C++ static variables and tracing use -- */

static long futex_call(_Atomic uint32_t *word, int operation, uint32_t value,
                       const struct timespec *timeout)
{
    struct thread *thread = self();
    int command = operation & FUTEX_CMD_MASK;
    clockid_t clock = operation & FUTEX_CLOCK_REALTIME ? CLOCK_REALTIME : CLOCK_MONOTONIC;
    long result;
    lock();
    if (command == FUTEX_WAKE || command == FUTEX_WAKE_BITSET) {
        result = wake_waiters(word, (int)value);
    } else if (atomic_load(word) != value) {
        errno = EAGAIN;
        result = -1;
    } else {
        int64_t deadline = NEVER;
        if (timeout && command == FUTEX_WAIT) /* relative */
            deadline = deadline_in(timeout->tv_sec * SECOND + timeout->tv_nsec);
        else if (timeout)
            deadline = deadline_at(clock, timeout);
        enum why why = wait_on(thread, word, deadline);
        result = why == WOKEN ? 0 : -1;
        if (why != WOKEN)
            errno = why == TIMED_OUT ? ETIMEDOUT : EINTR;
    }
    unlock();
    return result;
}

EXPORT long syscall(long number, ...)
{
    long a[6];
    va_list more;
    va_start(more, number);
    for (int i = 0; i < 6; i++)
        a[i] = va_arg(more, long);
    va_end(more);
    if (self() && number == SYS_futex) {
        int command = (int)a[1] & FUTEX_CMD_MASK;
        if (command == FUTEX_WAIT || command == FUTEX_WAKE || command == FUTEX_WAIT_BITSET ||
            command == FUTEX_WAKE_BITSET)
            return futex_call((void *)a[0], (int)a[1], (uint32_t)a[2], (void *)a[3]);
    }
    if (self() && number == SYS_close_range)
        return close_range((unsigned)a[0], (unsigned)a[1], (int)a[2]);
    if (self() && number == SYS_clock_gettime)
        return clock_gettime((clockid_t)a[0], (void *)a[1]);
    return REAL(syscall)(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

/* -- sleeps -- */

static int sleep_until(int64_t deadline)
{
    struct thread *thread = self();
    if (deadline <= now()) {
        waited_for_nothing();
        return 0;
    }
    lock();
    enum why why = wait_on(thread, thread, with_slack(deadline));
    unlock();
    return why == INTERRUPTED || why == BY_ITSELF ? EINTR : 0;
}

EXPORT int clock_nanosleep(clockid_t clock, int flags, const struct timespec *time,
                           struct timespec *left)
{
    if (!self() || clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID)
        return REAL(clock_nanosleep)(clock, flags, time, left);
    if (time->tv_nsec < 0 || time->tv_nsec >= SECOND || time->tv_sec < 0)
        return EINVAL;
    if (flags & TIMER_ABSTIME)
        return sleep_until(deadline_at(clock, time));
    int64_t deadline = deadline_in(deadline_at(CLOCK_MONOTONIC, time));
    int result = sleep_until(deadline);
    if (result == EINTR && left) {
        int64_t rest = deadline > now() ? deadline - now() : 0;
        *left = (struct timespec){rest / SECOND, rest % SECOND};
    }
    return result;
}

EXPORT int nanosleep(const struct timespec *time, struct timespec *left)
{
    int result = clock_nanosleep(CLOCK_MONOTONIC, 0, time, left);
    if (result)
        errno = result;
    return result ? -1 : 0;
}

EXPORT int usleep(useconds_t microseconds)
{
    struct timespec time = {microseconds / 1000000, microseconds % 1000000 * 1000};
    return nanosleep(&time, NULL);
}

EXPORT unsigned sleep(unsigned seconds)
{
    struct timespec time = {seconds, 0}, left = {0};
    return nanosleep(&time, &left) == 0 ? 0 : (unsigned)(left.tv_sec + (left.tv_nsec > 0));
}
