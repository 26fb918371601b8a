"""
Copy a notebook and its time of delivery to nbgrader's folder; write each file atomically.

Collecting Monday's zip after Tuesday's changes nothing: if the time of both notebooks is known, an
older notebook does not replace a newer copy.  If either time is unknown, as with Canvas, Moodle
and repositories, the new notebook replaces the copy, and a note in the table reports this.
"""

from __future__ import annotations

import os
from pathlib import Path

from autograder.collect.choice import Chosen
from autograder.collect.source.times import read_time, STAMP, stamp
from autograder.collect.table import LEFT, REPLACED, TAKEN, UNCHANGED
from autograder.files import keep
from autograder.submission.reading import read_file


def lay(one: Chosen, file_name: str, to: Path, write: bool) -> tuple[str, str]:
    """
    Write a notebook and its time of delivery, unless an equal or newer copy exists.

    :param file_name: file name of the assignment's notebook
    :param to: the folder of the class
    :param write: False to only report what would be done
    :returns: the value of ``Row.done``, and a note for the table
    :raises OSError: if the copy cannot be written
    :raises UnreadableError: if the notebook in the source can no longer be read
    """
    folder = to / one.handed.id / one.assignment
    for part in (folder.parent, folder):
        if part.is_symlink():
            raise NotADirectoryError(20, 'a link where a folder should be')
    notebook, time = folder / file_name, folder / STAMP
    wanted = stamp(one.when) if one.when else None
    there, _ = read_file(notebook, file_name)
    time_there, _ = read_file(time, STAMP)
    data = one.seen.piece.file.read()
    same = there == data
    if same and wanted in (None, time_there):
        return UNCHANGED, ''
    older, said = (False, '') if there is None else _older(wanted, time_there)
    if older:
        return (UNCHANGED, 'handed in again later') if same else (LEFT, said)
    if write:
        if wanted is None and os.path.lexists(time):
            # Remove the time first: if the process is killed between the two steps, the new
            # notebook must not keep the old time.
            time.unlink()
        if wanted is not None and wanted != time_there:
            keep(time, wanted)
        if not same:
            keep(notebook, data)
    replaced = there is not None or time_there is not None
    return (REPLACED if replaced else TAKEN), '' if same else said


def _older(wanted: bytes | None, there: bytes | None) -> tuple[bool, str]:
    """
    Return whether a notebook is older than the existing copy, and a note for the table.

    If either time is unknown, the notebook is treated as newer.

    :param wanted: content of the new ``timestamp.txt``
    :param there: content of the existing ``timestamp.txt``
    """
    texts = ((data or b'')[:100].decode('utf-8', 'replace') for data in (wanted, there))
    new, old = (read_time(text)[0] for text in texts)
    if new is None or old is None:
        return False, 'it is unknown which one is newer'
    return new < old, f'older than the collected one, of {old:%Y-%m-%d %H:%M}' if new < old else ''
