"""
The settings of each user's server under the hub.

For Jupyter, whatever a kernel sends is activity.  In this course a node keeps logging, and a live
picture keeps drawing, after the user has gone home.  So only cells and other requests count.
"""

from datetime import datetime, timezone
from typing import Any

from jupyter_client.session import Session
from jupyter_server.services.kernels.kernelmanager import AsyncMappingKernelManager


class KernelsIdleAfterTheirCells(AsyncMappingKernelManager):
    """A manager of kernels for which only the start and the end of a request are activity."""

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


c = get_config()  # defined by Jupyter
c.ServerApp.kernel_manager_class = KernelsIdleAfterTheirCells
