"""
Claim ROS domains, so that no two programs on this machine choose the same one.

A claim is an abstract Unix socket named after the domain.  It is not a file, all users of a
machine share the names, and the system frees a name however its process ends.  This module does
not import ROS.
"""

from collections.abc import Iterable
import errno
import socket
from typing import NamedTuple

DOMAINS = range(1, 102)
"""0 is ROS's default domain; above 101, Linux may assign the ports to other programs."""
NAME = 'ros2-course-domain-'
"""Prefix of a socket's name; the number of the domain follows."""


class Claim(NamedTuple):
    """A claimed domain, until the socket is closed; child processes do not inherit the socket."""

    domain: int
    holder: socket.socket


def claim(domains: Iterable[int]) -> Claim | None:
    """Claim the first free domain, or None; raise an OSError if there are no abstract sockets."""
    for domain in domains:
        holder = socket.socket(socket.AF_UNIX)
        try:
            holder.bind(f'\0{NAME}{domain}')
        except OSError as error:
            holder.close()
            if error.errno != errno.EADDRINUSE:
                raise
        else:
            return Claim(domain, holder)
    return None
