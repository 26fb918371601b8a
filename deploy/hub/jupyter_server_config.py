"""
The settings of each user's server under the hub.

By default, Jupyter counts all messages from kernels and requests from open pages as activity.  But
nodes keep logging, live pictures keep changing and pages stay open after the user has gone home.
So here only cells, terminals and requests that change files or grades count.
"""

from datetime import datetime, timezone
from typing import Any

from jupyter_client.session import Session
from jupyter_server.base.handlers import APIHandler, JupyterHandler
from jupyter_server.log import log_request
from jupyter_server.services.kernels.kernelmanager import AsyncMappingKernelManager

LAYOUT = '/lab/api/workspaces/'


class KernelsIdleAfterTheirCells(AsyncMappingKernelManager):
    """A kernel manager that counts only the start and the end of a request as activity."""

    def start_watching_activity(self, kernel_id: str) -> None:
        """Record when a kernel becomes busy or idle, and nothing else that it sends."""
        super().start_watching_activity(kernel_id)
        kernel = self.get_kernel(kernel_id)
        session = Session(config=kernel.session.config, key=kernel.session.key)

        def record(parts: list[Any]) -> None:
            message = session.deserialize(session.feed_identities(parts)[1])
            if message['msg_type'] != 'status':
                return
            if self.track_message_type(message['parent_header'].get('msg_type')):
                kernel.execution_state = message['content']['execution_state']
                kernel.last_activity = datetime.now(timezone.utc)
                self.last_kernel_activity = kernel.last_activity
            elif kernel.execution_state == 'starting':
                kernel.execution_state = 'idle'

        kernel._activity_stream.on_recv(record)


def log_and_count(handler: JupyterHandler) -> None:
    """
    Log a request, and count it as activity if it changes something.

    Even without its user, an open page keeps sending requests and saving its window layout.
    """
    log_request(handler)
    by_page = handler.request.method in ('GET', 'HEAD') or LAYOUT in handler.request.path
    if not by_page and handler.get_status() < 400:
        handler.settings['request_last_activity'] = datetime.now(timezone.utc)


APIHandler._track_activity = False  # log_and_count() also counts clicks on nbgrader's buttons

c = get_config()  # defined by Jupyter
c.ServerApp.kernel_manager_class = KernelsIdleAfterTheirCells
c.ServerApp.tornado_settings = {'log_function': log_and_count}
