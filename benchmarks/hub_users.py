"""
Measure a hub with one user, then with all users at once: time to the first plot, memory, messages.

Needs a running hub with first-use passwords (``make hub``), whose users have not logged in yet or
use this program's password, and root, which may read the memory of all processes.  Each user logs
in, starts a server and a kernel and runs the first cells of lesson 00, without a browser.  Then
each kernel publishes its user's name on one topic and lists the names that it receives.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
import json
import threading
import time
from typing import Any
import uuid

import psutil
import requests
import websocket

from autograder.layout import Layout
from benchmarks import report

PASSWORD = 'measured with this password'
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
LIMIT_S = 900.0
MIB = 2**20


@dataclass
class User:
    """
    One user of the hub, with the times that are measured [s].

    :param hub: address of the hub, with a slash at its end
    """

    hub: str
    name: str
    ready_s: float = 0.0
    plot_s: float = 0.0
    heard: tuple[str, ...] = ()
    memory_mib: float = 0.0
    session: requests.Session = field(default_factory=requests.Session)

    @property
    def server(self) -> str:
        """The address of the user's server."""
        return f'{self.hub}user/{self.name}/'

    def token(self, path: str) -> str:
        """Return the XSRF token for a path."""
        return str(self.session.cookies.get('_xsrf', path=path))

    def log_in(self) -> None:
        """Log in and wait until the user's server answers."""
        self.session.get(f'{self.hub}hub/login').raise_for_status()
        form = {'username': self.name, 'password': PASSWORD, '_xsrf': self.token('/hub/')}
        self.session.post(f'{self.hub}hub/login', data=form).raise_for_status()
        end = time.monotonic() + LIMIT_S
        while not self.session.get(f'{self.server}lab').url.startswith(self.server):
            if time.monotonic() > end:
                raise TimeoutError(f'{self.name}: the server did not start')
            time.sleep(0.2)

    def kernel(self) -> websocket.WebSocket:
        """Start a kernel in the folder of the lesson, and connect to it."""
        headers = {'X-XSRFToken': self.token(f'/user/{self.name}/')}
        body = {'name': 'ros2_jazzy', 'path': LESSON}
        answer = self.session.post(f'{self.server}api/kernels', json=body, headers=headers)
        answer.raise_for_status()
        address = f'{self.server}api/kernels/{answer.json()["id"]}/channels'
        request = requests.Request('GET', address)
        cookies = self.session.prepare_request(request).headers['Cookie']
        return websocket.create_connection(
            address.replace('http', 'ws', 1), cookie=cookies, timeout=LIMIT_S
        )


def run(kernel: websocket.WebSocket, code: str, until_svg: bool = False) -> str:
    """
    Run a cell and return what it printed.

    :param until_svg: return as soon as the cell shows a picture
    :raises RuntimeError: if the cell fails, or shows no picture
    """
    number, printed = uuid.uuid4().hex, ''
    header = {'msg_id': number, 'msg_type': 'execute_request', 'session': number, 'username': ''}
    header |= {'version': '5.3', 'date': ''}
    message = {'header': header, 'parent_header': {}, 'metadata': {}, 'channel': 'shell'}
    kernel.send(json.dumps({**message, 'content': {'code': code, 'silent': False}}))
    while True:
        found: Any = json.loads(kernel.recv())
        if found['parent_header'].get('msg_id') != number:
            continue
        kind, content = found['msg_type'], found['content']
        if kind == 'error':
            raise RuntimeError(f'{content["ename"]}: {content["evalue"]}')
        if kind == 'stream':
            printed += content['text']
        if until_svg and '<svg' in json.dumps(content.get('data', '')):
            return printed
        if kind == 'status' and content['execution_state'] == 'idle':
            if until_svg:
                raise RuntimeError(f'no picture after: {code}')
            return printed


def first_cells() -> list[str]:
    """Return the code cells of lesson 00 up to its first plot."""
    path = Layout.here().release(LESSON)
    cells = json.loads(path.read_text(encoding='utf-8'))['cells']
    codes = [''.join(one['source']) for one in cells if one['cell_type'] == 'code']
    last = next(number for number, code in enumerate(codes) if PLOT in code)
    return codes[: last + 1]


def work(user: User, together: threading.Barrier) -> User:
    """Do everything that one user does, and measure it."""
    begin = time.monotonic()
    user.log_in()
    user.ready_s = time.monotonic() - begin
    kernel = user.kernel()
    *before, plot = first_cells()
    for code in before:
        run(kernel, code)
    run(kernel, plot, until_svg=True)
    user.plot_s = time.monotonic() - begin
    run(kernel, CALLER.format(name=user.name))
    run(kernel, HEAR_ITSELF.format(name=user.name))
    together.wait(LIMIT_S)  # from now on, every kernel publishes
    time.sleep(CALLING_S)  # counts the names that arrive in this time
    # Log lines of the node can be among the output.
    lines = run(kernel, HEARD).splitlines()
    user.heard = next(tuple(line.split()[1:]) for line in lines if line.startswith('heard '))
    user.memory_mib = memory_of(user.name)
    together.wait(LIMIT_S)
    kernel.close()
    return user


def _work_or_abort(user: User, together: threading.Barrier) -> User:
    try:
        return work(user, together)
    except Exception:
        together.abort()  # the others do not wait for this user
        raise


def memory_of(name: str) -> float:
    """Return the memory of all processes of a user, shared pages divided [MiB]."""
    mine = [one for one in psutil.process_iter() if one.username() == name]
    return sum(float(one.memory_full_info().pss) for one in mine) / MIB


def measure(hub: str, names: Sequence[str]) -> dict[str, Any]:
    """Let users work at the same time, and return the figures."""
    together = threading.Barrier(len(names))
    with ThreadPoolExecutor(len(names)) as pool:
        users = list(pool.map(lambda name: _work_or_abort(User(hub, name), together), names))
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
