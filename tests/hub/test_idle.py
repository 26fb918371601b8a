"""A hub stops only the kernels and servers of users who do nothing."""

import re
import time

import psutil
import pytest

from tests.hub.running_hub import ANN, BOB, Hub, open_cells, run_cell
from tests.ros.live_kernels import DRAWS

pytestmark = [pytest.mark.hub, pytest.mark.timeout(3000)]

IDLE_MINUTES = 0.5
BETWEEN_CELLS_S, STOPPED_S = 15.0, 240.0
COUNTS = """\
number = globals().get('number', 0) + 1
print('cell', number, 'has run')"""


def processes_of(user: str) -> list[psutil.Process]:
    """Return the processes of a user: the server, its kernels and their programs."""
    return [one for one in psutil.process_iter() if one.username() == user]


def test_a_server_stops_when_only_its_page_plot_and_node_continue(hub: Hub) -> None:
    """The page stays open and in view. A server whose user runs cells keeps running."""
    ann, bob = hub.lab_of(ANN), hub.lab_of(BOB)
    open_cells(hub, bob, BOB, COUNTS)
    open_cells(hub, ann, ANN, DRAWS)
    run_cell(ann, 0, 'still here')
    ann.locator('.jp-OutputArea-output svg').wait_for()
    left, asked = processes_of(ANN), []
    commands = ' '.join(word for one in left for word in one.cmdline())
    kernels = re.findall(r'/kernel-(\S+)\.json', commands)
    ann.on('request', lambda request: asked.append(request.url))
    number, end = 0, time.monotonic() + STOPPED_S
    while left:
        assert time.monotonic() < end, left
        number += 1
        run_cell(bob, 0, f'cell {number} has run')
        left = psutil.wait_procs(left, timeout=BETWEEN_CELLS_S)[1]
    assert any('/api/' in url for url in asked), 'the page was not open'
    log = (hub.settings.run / 'hub.log').read_text()
    assert kernels
    assert all(re.search(rf'Culling .*\({one}\)', log) for one in kernels), 'not all were culled'
