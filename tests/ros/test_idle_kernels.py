"""A hub stops an idle kernel even if a node in it logs, or a picture keeps drawing."""

import asyncio
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from traitlets.config.loader import PyFileConfigLoader

from deploy.hub.prepare import SERVER_SETTINGS
from deploy.hub.settings import HERE
from environment.install_files import KERNEL_NAME
from tests.ros.live_kernels import DRAWS

pytestmark = [pytest.mark.ros, pytest.mark.slow]

STARTED_S = 120


async def activity(folder: Path) -> tuple[datetime, datetime, str]:
    """Return a kernel's last activity after a cell, and after later outputs, and its state."""
    settings = PyFileConfigLoader(SERVER_SETTINGS, str(HERE)).load_config()
    kernels = settings.ServerApp.kernel_manager_class(connection_dir=str(folder))
    kernel = kernels.get_kernel(await kernels.start_kernel(kernel_name=KERNEL_NAME))
    client = kernel.client()
    client.start_channels()
    try:
        await client.wait_for_ready(timeout=STARTED_S)
        started = kernel.last_activity
        content = {'code': DRAWS, 'silent': False, 'store_history': True, 'allow_stdin': False}
        # Only a cell of an open notebook has this metadata.
        cell = client.session.msg('execute_request', content, metadata={'cellId': 'one'})
        client.shell_channel.send(cell)
        await idle(client, cell)
        # The server reads the kernel's messages after this client, or before it.
        while kernel.last_activity == started or kernel.execution_state != 'idle':
            await client.get_iopub_msg(timeout=STARTED_S)
        ran = kernel.last_activity
        await outputs(client)
        return ran, kernel.last_activity, kernel.execution_state
    finally:
        client.stop_channels()
        await kernels.shutdown_kernel(kernel.kernel_id, now=True)


async def idle(client: Any, cell: Any) -> None:
    """Wait until a cell has ended."""
    state = None
    while state != 'idle':
        message = await client.get_iopub_msg(timeout=STARTED_S)
        assert message['msg_type'] != 'error', message['content']
        if message['parent_header'].get('msg_id') == cell['header']['msg_id']:
            state = message['content'].get('execution_state', state)


async def outputs(client: Any) -> None:
    """Wait until the kernel has sent another log line and another picture."""
    log_line = picture = False
    while not (log_line and picture):
        message = await client.get_iopub_msg(timeout=STARTED_S)
        log_line |= 'still here' in str(message['content'])
        picture |= message['msg_type'] == 'comm_msg'


def test_only_a_cell_is_activity(tmp_path: Path) -> None:
    """The kernel counts as idle from the end of its cell."""
    ran, later, state = asyncio.run(activity(tmp_path))
    assert ran == later
    assert state == 'idle'
