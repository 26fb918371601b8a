#!/bin/sh
# Start a kernel with a separate network and a separate /dev/shm: its nodes cannot exchange messages
# with the nodes of other users or kernels. Needs no root. Each step replaces the process before, so
# that signals reach the kernel itself.
#
# A program that starts its own kernel, such as `make execute`, may want to reach the kernel by TCP.
# No address leads into a separate network, so this kernel shares the network of the machine.
grep -qs -e '"transport": "tcp"' -- "$@" && exec "$@"

# `ip` and `mount` need the capabilities, which are dropped before the kernel starts.
exec unshare --user --map-current-user --keep-caps --net --mount sh -c '
  ip link set lo up && mount -t tmpfs tmpfs /dev/shm &&
  exec setpriv --inh-caps=-all --ambient-caps=-all "$@"' sh "$@"
