"""Use a running hub as a user does, without a browser: log in, press buttons, run cells."""

from dataclasses import dataclass, field
import json
import time
from typing import Any
import uuid

import requests
import websocket

PASSWORD = 'measured with this password'
LIMIT_S = 900.0


@dataclass
class User:
    """
    One user of the hub, who has never logged in or has the password in this module.

    :param hub: address of the hub, with a trailing slash
    :param name: account on the system
    """

    hub: str
    name: str
    session: requests.Session = field(default_factory=requests.Session, kw_only=True)

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

    def ask(self, method: str, path: str, /, **body: Any) -> Any:
        """
        Send a request to the user's server, as a button does, and return the JSON of the answer.

        :param body: JSON object of the request
        :raises requests.HTTPError: if the server refuses the request
        """
        headers = {'X-XSRFToken': self.token(f'/user/{self.name}/')}
        answer = self.session.request(method, self.server + path, json=body, headers=headers)
        answer.raise_for_status()
        return answer.json()

    def kernel(self, folder: str) -> websocket.WebSocket:
        """Start a kernel in a folder of the user's server, and connect to it."""
        number = self.ask('POST', 'api/kernels', name='ros2_jazzy', path=folder)['id']
        address = f'{self.server}api/kernels/{number}/channels'
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
