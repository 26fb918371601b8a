/*
 * Definitions for the driver and the library in each process, which share two pages, a socket and two
 * eventfds. README.md explains the protocol.
 */
#ifndef PROTOCOL_H
#define PROTOCOL_H

#include <stdatomic.h>
#include <stdint.h>

#define NEVER INT64_MAX
#define POST 0 /* the deadline of a process with posted datagrams */
#define SECOND INT64_C(1000000000)

#define ROOTS 4 /* maximum number of processes on the driver's command line */

/* The time of a run. The driver writes it; every process maps it read-only. */
struct time_page {
    _Atomic int64_t now; /* virtual CLOCK_MONOTONIC [ns] */
    int64_t to_realtime; /* virtual CLOCK_REALTIME minus virtual CLOCK_MONOTONIC [ns] */
    _Atomic int64_t ended[ROOTS]; /* virtual time at which each process of the command line ended, or 0 */
    _Atomic uint32_t posting; /* 1 while a portion of datagrams is sent: readers wait for all of it */
};

/* The state of a process is in the low two bits of its word. The other bits count the changes, so that
 * the driver can check that nothing happened between two looks. */
enum { BUSY = 0, IDLE = 1, CLAIMED = 2, STATE_BITS = 3, ONE_CHANGE = 4 };

/* Shared by one process and the driver. */
struct process_page {
    _Atomic uint32_t word;
    _Atomic int64_t deadline; /* if IDLE: the earliest time at which one of its threads continues */
};

/* Messages of one byte over the socket of a process. HELLO requests the descriptors below; after exec,
 * the new program image sends it again. ADOPT carries the driver's end of the socket of a child that the
 * process is about to create. */
enum { HELLO = 'h', ADOPT = 'a' };

/* The order of the descriptors in the reply to HELLO. */
enum { TIME_PAGE, PROCESS_PAGE, IN_FLIGHT, IS_IDLE, WAKE_UP, DESCRIPTORS };

#endif
