#!/bin/sh
# Start a kernel in a network and a /dev/shm of its own: no other user, and no other kernel, can
# hear its nodes or be heard by them. Needs no root. Every step replaces the one before, so that
# signals reach the kernel itself.
#
# The capabilities serve `ip` and `mount`, and are dropped before the kernel begins.
exec unshare --user --map-current-user --keep-caps --net --mount sh -c '
  ip link set lo up && mount -t tmpfs tmpfs /dev/shm &&
  exec setpriv --inh-caps=-all --ambient-caps=-all "$@"' sh "$@"
