"""
Open all lessons at once, in kernels of two users: each must run as if it were alone.

Both users work at the same time, each through every second lesson, while all other lessons are
open.  A kernel that waits for its turn publishes on topics that lessons use.
This takes minutes, so it belongs to ``make test-browser``.
"""

from ast import literal_eval
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, ExitStack
from pathlib import Path
import shutil

from jupyter_core.utils import ensure_event_loop
import nbformat
import pytest

from autograder.layout import lesson_files
from tests.ros.live_kernels import Kernel

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.notebooks, pytest.mark.slow]

LESSONS = lesson_files(Path(__file__).resolve().parents[2] / 'solutions')
USERS = ('ada', 'bob')
IMPORTS = """
from rclpy.node import Node as _Node
from rclpy.utilities import get_default_context as _context
from roslab import start as _start
from std_msgs.msg import String as _String
"""
"""Names that begin with an underscore hide no names of the lesson."""
IDLE = """
_idle = _start(_Node, name='idle')
for _topic in ('chatter', 'numbers', 'beacon_signal'):
    _idle.create_timer(0.1, lambda to=_idle.create_publisher(_String, _topic, 10): to.publish(
        _String(data='from another lesson')))
"""
SEEN = """
_observer = _start(_Node, name='observer')
_context().get_domain_id(), _observer.get_node_names()
"""


class OpenLesson:
    """A lesson in a separate kernel, with the exceptions and the stderr output of its cells."""

    def __init__(self, user: str, path: Path, home: Path) -> None:
        self.name = f'{user}: {path.stem}'
        self.cells = nbformat.read(path, as_version=4).cells
        folder = home / path.parent.name
        folder.mkdir()
        shutil.copy(path, folder)
        self.kernel = Kernel(folder, domain='')
        self.close = self.kernel.shut_down

    def work_through(self) -> list[str]:
        """Run all cells, and return the problems."""
        wrong = []
        for cell in self.cells:
            if cell.cell_type == 'code':
                outputs = self.kernel.run(cell.source, cell.id)
                said = (outputs.error or {}).get('evalue', ''), outputs.streams['stderr']
                wrong += [f'{self.name}, {cell.id}: {text}' for text in said if text]
        ensure_event_loop().close()  # the kernel's client created one for this thread
        return wrong


@pytest.fixture
def lessons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[OpenLesson]]:
    """Return all lessons of both users, opened but not run, the first user's first."""
    with ExitStack() as until:
        opened = []
        for user in USERS:
            home = tmp_path / user
            home.mkdir()
            monkeypatch.setenv('HOME', str(home))
            for path in LESSONS:
                opened.append(until.enter_context(closing(OpenLesson(user, path, home))))
        yield opened


def test_nothing_crosses_between_lessons_that_run_at_once(lessons: list[OpenLesson]) -> None:
    half = len(LESSONS)
    working = [one for number, one in enumerate(lessons) if (number + number // half) % 2 == 0]
    waiting = [one for one in lessons if one not in working]
    for one in waiting:
        assert one.kernel.run(IMPORTS + IDLE).error is None, one.name
    # Alternate between the users; the next lesson starts when one of two has ended.
    working.sort(key=lambda one: lessons.index(one) % half)
    with ThreadPoolExecutor(len(USERS)) as pool:
        wrong = [line for lines in pool.map(OpenLesson.work_through, working) for line in lines]
    seen = [literal_eval(one.kernel.run(IMPORTS + SEEN).value) for one in lessons]

    assert wrong == []
    assert len({domain for domain, _ in seen}) == len(lessons)
    for one, (_, names) in zip(lessons, seen):
        assert names.count('observer') == 1, (one.name, names)
        assert names.count('idle') == (one in waiting), (one.name, names)
