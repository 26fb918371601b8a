"""
Record which cell saved a file and when, and compare the file with the saved notebook.

``check`` judges files, not the screen: if a cell was edited but not run, the file still has the
old contents.  A kernel does not see what a browser shows, so this module reads the notebook file,
which JupyterLab saves every few seconds.
"""

from collections.abc import Collection, Iterable, Sequence
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from roslab.error_hints import read_cells
from roslab.output import shell

_MOST_NAMED = 3

_saves: dict[Path, tuple[int, int]] = {}
"""Execution number that saved each file, and the file's modification time afterwards [ns]."""


class SavedFile(NamedTuple):
    """
    A file of an exercise.

    :param execution: the n of the ``In [n]`` that saved the file, None if no cell of this kernel
        saved it
    :param modified_s: time of the last change [s since 1970]
    """

    path: Path
    execution: int | None
    modified_s: float

    def __str__(self) -> str:
        """Return the time of the save and the cell that saved the file, as text."""
        then, name = datetime.fromtimestamp(self.modified_s), self.path.name
        today = then.date() == datetime.now().date()
        clock = f'{then:%H:%M}' if today else f'{then:%d %b %H:%M}'
        unknown = self.execution is None
        by = 'another kernel or program' if unknown else f'In [{self.execution}]'
        return f'{name}, saved {clock} by {by}'


def note_save(path: Path) -> None:
    """Record that the running cell has saved a file."""
    history = getattr(getattr(shell(), 'history_manager', None), 'input_hist_raw', ())
    # The history ends with the running cell; the shell's own counter may already be higher.
    _saves[path] = max(0, len(history) - 1), path.stat().st_mtime_ns


def look_up(paths: Iterable[Path]) -> list[SavedFile]:
    """Return when and by which cells files were saved, in the order of saving."""
    found = []
    for path in paths:
        status = path.stat()
        number, saved_ns = _saves.get(path, (None, 0))
        # A different time means that another program has since written the file.
        execution = number if saved_ns == status.st_mtime_ns else None
        found.append(SavedFile(path, execution, status.st_mtime))
    return sorted(found, key=lambda file: file.modified_s)


def describe(files: Sequence[SavedFile]) -> str:
    """Return one line of text that names the judged files."""
    if len(files) <= _MOST_NAMED:
        return '; '.join(map(str, files))
    return f'{len(files)} files; the last one is {files[-1]}'


def edited_since(files: Collection[SavedFile]) -> list[str]:
    """
    Return the names of the files whose cell was edited after it had saved the file.

    The number of the cell in the saved notebook must be that of the run that saved the file.  If
    the notebook was saved before that run ended, its text may be older than the file.
    """
    bodies: dict[tuple[str, int | None], set[str]] = {}
    for cell in read_cells():
        if cell.file is not None:
            key = Path(cell.file.path).name, cell.execution
            bodies.setdefault(key, set()).add(cell.file.body)
    return [
        saved.path.name
        for saved in files
        if saved.execution is not None
        and (shown := bodies.get((saved.path.name, saved.execution)))
        and saved.path.read_text('utf-8', 'replace') not in shown
    ]
