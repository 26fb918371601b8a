"""
Show the output of a node below the cell that started it.

The kernel sends every line to the cell that is running.  Without this module, the lines of a node
would appear below whichever cell runs next.  So each cell that starts a node has a :class:`Page`
for everything that the callbacks of its nodes print or log.  While the cell runs, the page writes
to the cell's own output.  Afterwards it writes to one block below the cell, which is updated in
place and shows only the newest lines.

A notebook executed without a frontend also contains that block.  After a cell has ended,
``nbclient`` only accepts new contents for an existing display.  So the block is created, still
empty, at the end of the cell, and filled at the end of later cells.
"""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
import os
import stat
import sys
import threading
from typing import Any
import uuid

from roslab.console import ConsoleLines, log_text, MARK, mark_console, stop_terminal_copies
from roslab.interrupts import no_interrupts
from roslab.logtable import LogLine, record_logs
from roslab.output import Cell, current_cell

MOST_IN_CELL = 50
"""Maximum number of node lines that a running cell shows; further lines go into the block."""
MOST_IN_BLOCK = 12
_UPDATE_S = 0.25
_SETTLE_S = 2.0  # upper limit [s]; the wait normally takes a fraction of a millisecond
_LINE_S = 0.05


class Page:
    """
    The output lines of the nodes that one cell has started.

    Only the executor's thread writes to a page; all other threads only read it.
    """

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        self.display_id = uuid.uuid4().hex
        self.in_cell = 0
        self.in_block = 0
        self.changed = False
        self.displayed = False
        self._tail: deque[str] = deque(maxlen=MOST_IN_BLOCK)
        self._unfinished = ''

    def keep(self, text: str) -> None:
        """Add text to the block."""
        *lines, self._unfinished = (self._unfinished + text).split('\n')
        self._tail.extend(lines)
        self.in_block += len(lines)

    def text(self) -> str:
        """Return the text that the block shows."""
        tail = self._tail.copy()
        left_out = self.in_block - len(tail)
        head = [f'... {left_out} more, see logs()'] if left_out > 0 else []
        last = [self._unfinished] if self._unfinished else []
        return '\n'.join([*head, *tail, *last])


class Pages:
    """
    Sends the output of each thread to the correct cell.

    :param console: processes the marked log lines in the output that the kernel reads back
    """

    def __init__(self, stream: Any, console: ConsoleLines) -> None:
        self._stream = stream
        self._plain: Callable[[str], int | None] = stream.write
        self._console = console
        self._watcher = getattr(stream, 'watch_fd_thread', None)
        self._arrived = threading.Event()
        self._whole = threading.Event()  # set while Python's output is at the end of a line
        self._whole.set()
        self._here = threading.local()
        running = current_cell()
        self._running = running if running and running.request else None
        self._of_running: Page | None = None
        self._changed: dict[str, Page] = {}
        stream.write = self.write

    def page(self) -> Page | None:
        """Return the page of the running cell, for nodes that the cell starts."""
        if self._of_running is None and self._running is not None:
            self._of_running = Page(self._running)
        return self._of_running

    @contextmanager
    def output_below(self, page: Page) -> Iterator[None]:
        """Do what :func:`output_below` does."""
        outer = getattr(self._here, 'page', None)
        token = self._stream.set_thread_parent(page.cell.request)
        self._here.page = page
        try:
            yield
        finally:
            self._here.page = outer
            self._stream.reset_thread_parent(token)

    def write(self, text: str) -> int | None:
        """Write to the cell that this thread belongs to, like ``write`` of the kernel's stdout."""
        if threading.current_thread() is self._watcher:
            mark = self._console.marks
            text = self._console.feed(text)
            # `print` writes a line and its newline separately.  If no newline follows, wait only
            # once.
            if text and not self._whole.wait(_LINE_S):
                self._whole.set()
            written = self._plain(text) if text else 0
            if self._console.marks > mark:
                self._arrived.set()
            return written
        page: Page | None = getattr(self._here, 'page', None)
        if page is None or not isinstance(text, str):
            return self._written(text)
        if page.cell is self._running and page.in_cell < MOST_IN_CELL and not page.in_block:
            page.in_cell += text.count('\n')
            return self._written(text)
        page.keep(text)
        self._note(page)
        return len(text)

    def _written(self, text: Any) -> int | None:
        """Write Python's output so that no output from C code interrupts a line."""
        open_line = isinstance(text, str) and text != '' and not text.endswith('\n')
        if open_line:
            self._whole.clear()
        try:
            return self._plain(text)
        finally:
            if not open_line and text:
                self._whole.set()

    def write_log(self, line: LogLine) -> None:
        """Show a log line in the cell that this thread belongs to."""
        self.write(f'{log_text(line.level, line.logger, line.message)}\n')

    def begin_cell(self, _: Any = None) -> None:
        """Record which cell is running."""
        self._running, self._of_running = current_cell(), None

    def end_cell(self, _: Any = None) -> None:
        """Deliver all output before the kernel reports the end of the cell."""
        with no_interrupts():
            self._settle()
            over, page = self._running, self._of_running
            self._running, self._of_running = None, None
            if page is not None and not page.cell.has_frontend and not page.displayed:
                self._send(page, 'display_data', page.cell)
            for changed in tuple(self._changed.values()):
                self._update(changed, over)

    def _settle(self) -> None:
        """
        Wait until the output of C code has reached the running cell.

        ROS writes log lines into a pipe, and the kernel assigns what it reads from the pipe to the
        cell that runs at that moment, which is the next cell if this one was quick.  So this
        method writes a mark into the pipe and waits until the kernel has read it.
        """
        watcher = self._watcher
        if watcher is None or not watcher.is_alive() or not stat.S_ISFIFO(os.fstat(1).st_mode):
            return
        self._arrived.clear()
        os.write(1, MARK)
        self._arrived.wait(_SETTLE_S)
        self._stream.flush()

    def _note(self, page: Page) -> None:
        """Show a page soon; without a frontend, do so at the end of the running cell."""
        if page.changed:
            return
        page.changed = True
        self._changed[page.display_id] = page
        if page.cell.has_frontend:
            thread = self._stream.pub_thread
            thread.schedule(
                lambda: thread.io_loop.call_later(_UPDATE_S, self._update, page, page.cell)
            )

    def _update(self, page: Page, parent: Cell | None) -> None:
        if parent is None or not page.changed:
            return
        page.changed = False  # reset first, so that a line arriving now triggers another update
        self._changed.pop(page.display_id, None)
        if page.cell.has_frontend:
            parent = page.cell
        self._send(page, 'update_display_data' if page.displayed else 'display_data', parent)

    def _send(self, page: Page, kind: str, parent: Cell) -> None:
        page.displayed = True
        session = self._stream.session
        content = {
            'data': {'text/plain': page.text()},
            'metadata': {},
            'transient': {'display_id': page.display_id},
        }
        message = session.msg(kind, content, parent=dict(parent.request))
        session.send(self._stream.pub_thread, message, ident=b'display_data')


_pages: Pages | None = None


def lay_out(shell: Any) -> None:
    """Start sending the output of nodes to the cells that started them."""
    global _pages
    stream: Any = sys.stdout
    can = ('set_thread_parent', 'pub_thread')
    if _pages is not None or not all(hasattr(stream, name) for name in can):
        return
    _pages = Pages(stream, ConsoleLines())
    stop_terminal_copies(stream)
    # A kernel that does not read its own stdout never shows lines of C code, so no line can
    # appear twice.
    if getattr(stream, 'watch_fd_thread', None) is None or mark_console():
        record_logs(_pages.write_log)
    shell.events.register('pre_run_cell', _pages.begin_cell)
    shell.events.register('post_run_cell', _pages.end_cell)


def page_here() -> Page | None:
    """Return the page of the running cell, for nodes that the cell starts."""
    return _pages.page() if _pages is not None else None


def output_below(page: Page | None) -> AbstractContextManager[None]:
    """Send what this thread prints and logs to a page inside the ``with`` block."""
    return nullcontext() if _pages is None or page is None else _pages.output_below(page)
