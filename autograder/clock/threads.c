/*
 * The threads of this process: how they wait, and how they are woken.
 *
 * One lock guards a table of threads. A thread runs, or waits on an address until a deadline. Waking a
 * thread counts it as running before it really runs, so no thread is ever "woken but not yet awake". When
 * the last running thread begins to wait, the process becomes IDLE and reports this to the driver. When a
 * thread runs again, the process becomes BUSY.
 */
#include "library.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <linux/futex.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>

#define SLACK (SECOND / 20000) /* 50 us */

_Atomic bool active;
_Atomic int interpreter_wanted;
struct functions functions;

static struct thread table[MAX_THREADS];
static int used;    /* number of table entries that have ever been used */
static int running; /* number of threads that do not wait */
static uint64_t places;
static uint64_t work; /* how many times a thread that does not poll has begun to run */
static struct process_page *page;
static const struct time_page *timing;
static int is_idle;
static _Atomic bool posts; /* whether this process sends the current portion of datagrams */
static pthread_key_t at_end;
static __thread struct thread *me __attribute__((tls_model("initial-exec")));
static __thread bool outside __attribute__((tls_model("initial-exec")));

void look_up(void)
{
#define X(name) functions.name = (__typeof__(&name))dlsym(RTLD_NEXT, #name);
    FUNCTIONS(X)
#undef X
}

/* -- the lock, which is a futex because the library's own pthread_mutex_lock uses the lock -- */

static _Atomic uint32_t guard; /* 0 free, 1 held, 2 held and contended */

/* Call futex(2), and return a negative error number on failure; leave the program's errno unchanged. */
static long futex(_Atomic uint32_t *word, int operation, uint32_t value, const struct timespec *in)
{
    int before = errno;
    long result = REAL(syscall)(SYS_futex, word, operation | FUTEX_PRIVATE_FLAG, value, in, NULL, 0);
    if (result < 0)
        result = -errno;
    errno = before;
    return result;
}

void lock(void)
{
    uint32_t free = 0;
    if (atomic_compare_exchange_strong(&guard, &free, 1))
        return;
    while (atomic_exchange(&guard, 2) != 0)
        futex(&guard, FUTEX_WAIT, 2, NULL);
}

void unlock(void)
{
    if (atomic_exchange(&guard, 0) == 2)
        futex(&guard, FUTEX_WAKE, 1, NULL);
}

/* -- time -- */

int64_t now(void) { return atomic_load(&timing->now); }

int64_t realtime(void) { return now() + timing->to_realtime; }

int64_t deadline_in(int64_t nanoseconds)
{
    int64_t at;
    if (nanoseconds < 0)
        nanoseconds = 0;
    return __builtin_add_overflow(now(), nanoseconds, &at) ? NEVER : at;
}

/* Convert a time of a clock to virtual CLOCK_MONOTONIC; NULL becomes NEVER. */
int64_t deadline_at(clockid_t clock, const struct timespec *at)
{
    int64_t sum;
    if (!at)
        return NEVER;
    if (__builtin_mul_overflow((int64_t)at->tv_sec, SECOND, &sum) ||
        __builtin_add_overflow(sum, (int64_t)at->tv_nsec, &sum))
        return at->tv_sec < 0 ? 0 : NEVER;
    return clock == CLOCK_REALTIME || clock == CLOCK_TAI ? sum - timing->to_realtime : sum;
}

/* Delay a deadline at least to the end of Linux's timer slack, for sleeps and waits for descriptors. */
int64_t with_slack(int64_t deadline)
{
    int64_t earliest = deadline_in(SLACK);
    return deadline < earliest ? earliest : deadline;
}

/* -- the state of the process -- */

static void set_state(uint32_t state)
{
    uint32_t word = atomic_load(&page->word), changed;
    do
        changed = ((word & ~(uint32_t)STATE_BITS) + ONE_CHANGE) | state;
    while (!atomic_compare_exchange_weak(&page->word, &word, changed));
}

/* Report to the driver that every thread waits, and the earliest deadline. */
static void report_idle(void)
{
    int before = errno;
    int64_t earliest = has_post() ? POST : first_timer();
    uint64_t once = 1;
    for (int i = 0; i < used; i++)
        if (table[i].used && table[i].waiting && table[i].deadline < earliest)
            earliest = table[i].deadline;
    atomic_store(&page->deadline, earliest);
    posts = false;
    set_state(IDLE);
    if (REAL(write)(is_idle, &once, sizeof once) < 0)
        errno = before; /* the driver has ended, so the grader will end this process */
}

static void one_more_runs(void)
{
    if (running++ == 0)
        set_state(BUSY);
}

static bool wake_polling(void);

static void one_less_runs(void)
{
    if (--running == 0 && !wake_polling())
        report_idle();
}

/* Wait until another process has sent its whole portion of datagrams. The first datagrams wake a reader,
 * and how many more the reader then finds must not depend on the speed of the processes. */
void wait_for_portion(void)
{
    while (atomic_load(&timing->posting) && !posts)
        REAL(syscall)(SYS_futex, &timing->posting, FUTEX_WAIT, 1, NULL, NULL, 0);
}

/* -- waiting -- */

void begin_wait(struct thread *thread, const void *on, int64_t deadline)
{
    let_go(thread);
    thread->on = on;
    thread->deadline = deadline;
    thread->place = ++places;
    thread->why = BY_ITSELF;
    thread->reads = thread->empty_waits = 0;
    if (!thread->polling)
        thread->steps = 0;
    atomic_store(&thread->word, 0);
    thread->waiting = true;
    one_less_runs();
}

/* Mark a thread as running after a wait; data or a signal may have ended the wait without a wake-up. */
enum why end_wait(struct thread *thread)
{
    thread->held_by = NULL;
    if (thread->waiting) {
        thread->waiting = false;
        one_more_runs();
        work++;
    }
    return thread->why;
}

static void start(struct thread *thread)
{
    atomic_store(&thread->word, 1);
    if (thread->in_poll)
        eventfd_write(thread->eventfd, 1);
    else
        futex(&thread->word, FUTEX_WAKE, 1, NULL);
}

/* Release the threads that this thread has woken while it received datagrams. */
void let_go(struct thread *thread)
{
    for (int i = 0; thread->receiving && i < used; i++)
        if (table[i].held_by == thread) {
            table[i].held_by = NULL;
            start(&table[i]);
        }
    thread->receiving = false;
}

void begin_receiving(void) { me->receiving = true; }

void end_receiving(void)
{
    if (me && me->receiving) {
        lock();
        let_go(me);
        unlock();
    }
}

static void wake(struct thread *thread, enum why why)
{
    thread->waiting = false;
    thread->why = why;
    one_more_runs();
    if (!thread->polling)
        work++;
    if (me && me->receiving)
        thread->held_by = me;
    else
        start(thread);
}

/* Wait until another thread wakes the waiters of this address, a signal arrives or the deadline has
 * passed. The lock is released during the wait. */
enum why wait_on(struct thread *thread, const void *on, int64_t deadline)
{
    begin_wait(thread, on, deadline);
    unlock();
    while (atomic_load(&thread->word) == 0 && futex(&thread->word, FUTEX_WAIT, 0, NULL) != -EINTR)
        ;
    lock();
    return end_wait(thread);
}

/*
 * Wait for the interpreter lock (waits.c), with a limit in real time [ns]. The thread that holds the lock
 * may read the clock in a loop, so the library makes no thread sleep for polling during this wait.
 */
enum why wait_for_interpreter(struct thread *thread, const void *on, int64_t limit)
{
    struct timespec in = {limit / SECOND, limit % SECOND};
    interpreter_wanted++;
    begin_wait(thread, on, NEVER);
    unlock();
    if (atomic_load(&thread->word) == 0)
        futex(&thread->word, FUTEX_WAIT, 0, &in);
    lock();
    interpreter_wanted--;
    return end_wait(thread);
}

/* Wake at most `most` threads that wait on an address, in the order of their arrival; return how many. */
int wake_waiters(const void *on, int most)
{
    int woken = 0;
    for (; woken < most; woken++) {
        struct thread *first = NULL;
        for (int i = 0; i < used; i++)
            if (table[i].used && table[i].waiting && table[i].on == on &&
                (!first || table[i].place < first->place))
                first = &table[i];
        if (!first)
            break;
        wake(first, WOKEN);
    }
    return woken;
}

/*
 * Sleep until a deadline instead of reading the clock in a loop (clocks.c). If any other thread works in
 * the meantime, the sleep ends before time advances: the thread may hold the interpreter lock, or its loop
 * may wait for the result of the other thread.
 */
void sleep_polling(struct thread *thread, int64_t deadline)
{
    thread->polling = true;
    thread->work = running > 1 ? work - 1 : work;
    wait_on(thread, thread, deadline);
    thread->polling = false;
}

/* Wake polling threads if a thread that does not poll has worked since; return whether any was woken. */
static bool wake_polling(void)
{
    bool any = false;
    for (int i = 0; i < used; i++)
        if (table[i].used && table[i].waiting && table[i].polling && table[i].work != work) {
            wake(&table[i], WOKEN);
            any = true;
        }
    return any;
}

/* Send a signal to the main thread, and count the thread as running, because it handles the signal. */
void interrupt_main(int signal)
{
    REAL(syscall)(SYS_tgkill, getpid(), getpid(), signal);
    if (table[0].used && table[0].waiting)
        wake(&table[0], INTERRUPTED);
}

/* Send a portion of posted datagrams, or wake the thread or timer that is due first. The next one follows
 * when all threads wait again. */
void wake_due(void)
{
    struct thread *first = NULL;
    if (running > 0)
        return; /* the process reports again when these threads wait */
    if (has_post()) {
        one_more_runs(); /* stay BUSY while the portion is sent */
        posts = true;
        send_portion();
        one_less_runs();
        return;
    }
    for (int i = 0; i < used; i++)
        if (table[i].used && table[i].waiting && table[i].deadline <= now() &&
            (!first || table[i].deadline < first->deadline))
            first = &table[i];
    if (first_timer() <= now() && (!first || first_timer() <= first->deadline)) {
        one_more_runs(); /* stay BUSY until the timer has sent its signal */
        fire_timer();
        one_less_runs();
    } else if (first) {
        wake(first, TIMED_OUT);
    } else {
        report_idle();
    }
}

/* -- start and end of threads -- */

static struct thread *add_thread(void)
{
    int i = 0;
    while (i < used && table[i].used)
        i++;
    if (i == MAX_THREADS)
        return NULL;
    if (i == used)
        used++;
    /* An entry of the table keeps its eventfd, which is never 0. */
    table[i] = (struct thread){.used = true, .eventfd = table[i].eventfd ? table[i].eventfd : -1};
    one_more_runs();
    return &table[i];
}

struct thread *self(void)
{
    if (!active || outside)
        return NULL;
    if (!me) { /* a thread that was not created by pthread_create */
        lock();
        me = add_thread();
        unlock();
        outside = !me;
    }
    return me;
}

void leave_clock(void) { outside = true; }

#ifdef __SANITIZE_THREAD__ /* ThreadSanitizer releases its data of a thread in the last round */
#define LAST_ROUND (PTHREAD_DESTRUCTOR_ITERATIONS - 1)
#else
#define LAST_ROUND PTHREAD_DESTRUCTOR_ITERATIONS
#endif

/* The destructor of a thread's own data; its last round is the last code that a thread runs. */
static void end_thread(void *round)
{
    if ((intptr_t)round < LAST_ROUND) {
        pthread_setspecific(at_end, (void *)((intptr_t)round + 1));
        return;
    }
    lock();
    struct thread *thread = me;
    let_go(thread);
    outside = true;
    me = NULL;
    thread->used = false;
    wake_waiters(thread, INT_MAX); /* threads that join this one */
    one_less_runs();
    unlock();
}

static void *begin_thread(void *record)
{
    lock(); /* wait until pthread_create has stored the id of this thread */
    unlock();
    me = record;
    pthread_setspecific(at_end, (void *)1);
    return me->start(me->argument);
}

EXPORT int pthread_create(pthread_t *id, const pthread_attr_t *attributes, void *(*start)(void *),
                          void *argument)
{
    if (!self())
        return REAL(pthread_create)(id, attributes, start, argument);
    lock();
    struct thread *thread = add_thread(); /* counted as running before it exists */
    int result = EAGAIN;
    if (thread) {
        thread->start = start;
        thread->argument = argument;
        result = REAL(pthread_create)(id, attributes, begin_thread, thread);
        thread->id = *id;
    }
    if (thread && result != 0) {
        thread->used = false;
        one_less_runs();
    }
    unlock();
    return result;
}

static struct thread *thread_with(pthread_t id)
{
    for (int i = 0; i < used; i++)
        if (table[i].used && table[i].start && table[i].id == id)
            return &table[i];
    return NULL;
}

/* Wait until a thread has ended; return false if the deadline passes first. */
static bool wait_for_end(pthread_t id, int64_t deadline)
{
    struct thread *thread = self(), *other = NULL;
    lock();
    while (thread && (other = thread_with(id)))
        if (wait_on(thread, other, deadline) == TIMED_OUT)
            break;
    unlock();
    return !other;
}

EXPORT int pthread_join(pthread_t id, void **result)
{
    wait_for_end(id, NEVER);
    return REAL(pthread_join)(id, result);
}

EXPORT int pthread_clockjoin_np(pthread_t id, void **result, clockid_t clock,
                                const struct timespec *at)
{
    if (!self())
        return REAL(pthread_clockjoin_np)(id, result, clock, at);
    return wait_for_end(id, deadline_at(clock, at)) ? REAL(pthread_join)(id, result) : ETIMEDOUT;
}

EXPORT int pthread_timedjoin_np(pthread_t id, void **result, const struct timespec *at)
{
    return pthread_clockjoin_np(id, result, CLOCK_REALTIME, at);
}

/* Initialise the table with only the calling thread, in a new process or a new program image. */
void begin_threads(struct process_page *shared, const struct time_page *time, int report_to)
{
    static bool again;
    if (!again)
        pthread_key_create(&at_end, end_thread);
    again = true;
    page = shared;
    timing = time;
    is_idle = report_to;
    atomic_store(&guard, 0);
    outside = posts = false;
    used = running = interpreter_wanted = 0;
    for (int i = 0; i < MAX_THREADS; i++)
        table[i] = (struct thread){.eventfd = -1};
    me = add_thread();
}
