"""
Measure a hub with one user, then with all users at once: time to the first plot, memory, messages.

The program needs root, to read the memory of processes, and a running hub with first-use passwords
(``make hub``).  Its users have not logged in yet or use this program's password.  Each user logs
in, starts a server and a kernel and runs the first cells of lesson 00, without a browser.  Then
each kernel publishes its user's name on one topic and lists the names that it receives.
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
import json
import threading
import time
from typing import Any

import psutil

from autograder.layout import Layout
from benchmarks import report
from deploy.hub.user import LIMIT_S, run, User

LESSON = '00_quick_tour'
PLOT = 'plot('
CALLER = """
from rclpy.node import Node
from roslab import start
from std_msgs.msg import String

class Caller(Node):
    def __init__(self):
        super().__init__('caller')
        self.heard = set()
        out = self.create_publisher(String, 'who', 10)
        self.create_subscription(String, 'who', lambda message: self.heard.add(message.data), 10)
        self.create_timer(0.05, lambda: out.publish(String(data={name!r})))

caller = start(Caller)
"""
HEAR_ITSELF = """
import time

while {name!r} not in caller.heard:
    time.sleep(0.05)
"""
HEARD = "print('heard', *sorted(caller.heard))"
CALLING_S = 5.0
MIB = 2**20


@dataclass
class Measured(User):
    """One user of the hub, with the measured values."""

    ready_s: float = 0.0
    plot_s: float = 0.0
    heard: tuple[str, ...] = ()
    memory_mib: float = 0.0


def first_cells() -> list[str]:
    """Return the code cells of lesson 00 up to its first plot."""
    path = Layout.here().release(LESSON)
    cells = json.loads(path.read_text(encoding='utf-8'))['cells']
    codes = [''.join(one['source']) for one in cells if one['cell_type'] == 'code']
    last = next(number for number, code in enumerate(codes) if PLOT in code)
    return codes[: last + 1]


def work(user: Measured, together: threading.Barrier) -> Measured:
    """Do everything that one user does, and measure it."""
    begin = time.monotonic()
    user.log_in()
    user.ready_s = time.monotonic() - begin
    kernel = user.kernel(LESSON)
    *before, plot = first_cells()
    for code in before:
        run(kernel, code)
    run(kernel, plot, until_svg=True)
    user.plot_s = time.monotonic() - begin
    run(kernel, CALLER.format(name=user.name))
    run(kernel, HEAR_ITSELF.format(name=user.name))
    together.wait(LIMIT_S)  # from now on, every kernel publishes
    time.sleep(CALLING_S)  # the node records the names that arrive meanwhile
    # Log lines of the node can be among the output.
    lines = run(kernel, HEARD).splitlines()
    user.heard = next(tuple(line.split()[1:]) for line in lines if line.startswith('heard '))
    user.memory_mib = memory_of(user.name)
    together.wait(LIMIT_S)
    kernel.close()
    return user


def _work_or_abort(user: Measured, together: threading.Barrier) -> Measured:
    try:
        return work(user, together)
    except Exception:
        together.abort()  # the others do not wait for this user
        raise


def memory_of(name: str) -> float:
    """Return the proportional set size (PSS) of all processes of a user [MiB]."""
    mine = [one for one in psutil.process_iter(['username']) if one.info['username'] == name]
    return sum(float(one.memory_full_info().pss) for one in mine) / MIB


def measure(hub: str, names: Sequence[str]) -> dict[str, Any]:
    """Let users work at the same time, and return the figures."""
    together = threading.Barrier(len(names))
    with ThreadPoolExecutor(len(names)) as pool:
        users = list(pool.map(lambda name: _work_or_abort(Measured(hub, name), together), names))
    crossed = {user.name: user.heard for user in users if user.heard != (user.name,)}
    return {
        'ready_s': report.spread([user.ready_s for user in users]),
        'first_plot_s': report.spread([user.plot_s for user in users]),
        'memory_mib': report.spread([user.memory_mib for user in users]),
        'received_from_others': crossed,
    }


def main() -> int:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=(__doc__ or '').strip().splitlines()[0])
    parser.add_argument('--hub', default='http://127.0.0.1:8000/', metavar='ADDRESS')
    parser.add_argument('users', nargs='+', help='names of users; the first one starts alone')
    chosen = parser.parse_args()
    machine = report.machine()
    one, *others = chosen.users
    figures = {}
    for name, users in (('alone', [one]), ('together', others)):
        figures[name] = measure(chosen.hub, users)
        print(name, json.dumps(figures[name], indent=2), flush=True)
    report.save('hub_users', machine, figures, full=len(others) >= 10)
    return 0


if __name__ == '__main__':
    raise SystemExit(main())
