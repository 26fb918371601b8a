"""
Start the driver of a run's virtual clock, and create a place on the clock for each process.

A place is a position in the driver's order of processes, with a socket to the driver.  A process
inherits one end of the socket; the environment variable ``VIRTUAL_CLOCK`` contains the descriptor.
The library that ``LD_PRELOAD`` loads connects the process to the driver.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, ExitStack
from dataclasses import dataclass
import mmap
import os
from pathlib import Path
import socket
import struct
import subprocess
import sys

from autograder.errors import SandboxUnavailable

SYSTEM_TIME_NS = 1_767_225_600_000_000_000
"""System time at the start of a run [ns]: 2026-01-01 00:00 UTC, fixed so that recordings agree."""
FOLDER = Path('ros2_course', 'clock')
_ROOTS = 4
_PAGE = struct.Struct(f'=qq{_ROOTS}q')  # struct time_page of protocol.h
_START_NS = 1_000_000_000_000  # CLOCK_MONOTONIC at the start, see driver.c


@dataclass(frozen=True)
class VirtualClock:
    """
    The virtual clock of one run.

    :param driver: the process that advances the time
    :param places: sockets for the processes of the run, in the order in which the driver serves
        them
    :param library: path of the library that these processes load
    :param page: the time page, read-only
    """

    driver: subprocess.Popen[bytes]
    places: tuple[socket.socket, ...]
    library: str
    page: mmap.mmap

    def variables(self, place: int) -> Mapping[str, str]:
        """Return the environment variables for a process that inherits the socket of a place."""
        number = str(self.places[place].fileno())
        return {'LD_PRELOAD': self.library, 'VIRTUAL_CLOCK': number}

    def command(self, place: int, later: bool = False) -> tuple[str, ...]:
        """
        Return the prefix of a command line that starts a program with a place.

        :param later: only pass the path of the library in ``CLOCK_LIBRARY``, so that the program
            can preload it for another program that it executes
        """
        names = dict(self.variables(place))
        if later:
            names['CLOCK_LIBRARY'] = names.pop('LD_PRELOAD')
        return ('env', *(f'{name}={value}' for name, value in names.items()))

    def begin(self) -> None:
        """Close this process's copies of the sockets, so that the driver sees the others close."""
        for place in self.places:
            place.close()

    @property
    def elapsed_ns(self) -> int:
        """Return the virtual time since the start of the run [ns]."""
        return max(0, int(_PAGE.unpack_from(self.page)[0]) - _START_NS)

    def ended_ns(self, place: int) -> int | None:
        """Return when the process of a place ended, as :attr:`elapsed_ns`; None while it runs."""
        ended = int(_PAGE.unpack_from(self.page)[2 + place])
        return ended - _START_NS if ended else None


def clock_programs() -> tuple[str, str]:
    """
    Return the paths of the driver and of the library.

    :raises SandboxUnavailable: if the set-up has not built them
    """
    # Resolve links, because a link may be missing in a sandbox.
    folder = Path(sys.prefix).resolve() / FOLDER
    if not (folder / 'driver').is_file():
        raise SandboxUnavailable('The virtual clock is not built.', 'Try: make prepare')
    return str(folder / 'driver'), str(folder / 'clock.so')


def check_clock() -> None:
    """
    Check that a program of this system can load the library.

    :raises SandboxUnavailable: if it cannot, or the set-up has not built the clock
    """
    _, library = clock_programs()
    # The loader prints an error, but some errors do not end the program.
    tried = subprocess.run(['true'], env={'LD_PRELOAD': library}, capture_output=True, check=False)
    if not tried.stderr:
        return
    if os.statvfs(library).f_flag & os.ST_NOEXEC:
        raise SandboxUnavailable(
            f'{library}: the file system is mounted noexec, so programs cannot load the clock.',
            'Try: make VENV=... with a folder on a different file system',
        )
    said = tried.stderr.decode(errors='replace').strip().splitlines()[-1]
    raise SandboxUnavailable(
        f'Programs cannot load the virtual clock: {said.rstrip(".")}.',
        'Try: make clean, then make prepare, which builds the clock for this system',
    )


@contextmanager
def virtual_clock(places: int) -> Iterator[VirtualClock]:
    """
    Yield the virtual clock of one run, and end its driver afterwards.

    :param places: number of processes that the run starts; their children get further places
    :raises SandboxUnavailable: if the set-up has not built the clock
    """
    driver_file, library = clock_programs()
    with ExitStack() as ours, ExitStack() as of_driver:
        sockets, given = [], []
        for _ in range(places):
            one, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            sockets.append(ours.enter_context(one))
            given.append(of_driver.enter_context(other).fileno())
            # Set this before a process sends its first message: the driver reads the process id
            # from the credentials of that message.
            other.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        page_fd = os.memfd_create('time', os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        of_driver.callback(os.close, page_fd)
        os.ftruncate(page_fd, _PAGE.size)
        page = ours.enter_context(mmap.mmap(page_fd, _PAGE.size, prot=mmap.PROT_READ))
        driver = subprocess.Popen(
            [driver_file, *map(str, (SYSTEM_TIME_NS, page_fd, *given))],
            pass_fds=(page_fd, *given),
            env={},
            # Leave the terminal's process group, because Ctrl-C must not end the driver.
            start_new_session=True,
        )
        ours.callback(driver.wait)
        ours.callback(driver.kill)
        of_driver.close()
        yield VirtualClock(driver, tuple(sockets), library, page)
