#!/bin/sh
# Start a kernel with a separate network and a separate /dev/shm: its nodes cannot exchange messages
# with the nodes of other users or kernels. It needs no root. Each step replaces the previous process,
# so that signals reach the kernel itself.
#
# A program that starts its own kernel, such as `make execute`, may connect to the kernel over TCP.
# No address leads into a separate network, so such a kernel shares the machine's network.
grep -qs -e '"transport": "tcp"' -- "$@" && exec "$@"

# `ip` and `mount` need the capabilities, which are dropped before the kernel starts.
exec unshare --user --map-current-user --keep-caps --net --mount sh -c '
  ip link set lo up && mount -t tmpfs tmpfs /dev/shm &&
  exec setpriv --inh-caps=-all --ambient-caps=-all "$@"' sh "$@"
