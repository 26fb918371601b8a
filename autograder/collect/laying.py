"""A notebook and its time, laid where nbgrader looks for them; each whole or not at all."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from autograder.collect.choice import Chosen
from autograder.collect.table import REPLACED, TAKEN, UNCHANGED
from autograder.collect.times import STAMP, stamp
from autograder.runs.recording import keep
from autograder.whole_class.inbox import read_file


def lay(one: Chosen, file_name: str, to: Path, write: bool) -> str:
    """
    Write a notebook and its time, unless they are there.

    :param file_name: of the assignment's notebook
    :param to: the folder of the class
    :param write: False to only say what would be done
    :returns: a word for the table
    :raises OSError: if it cannot be written
    :raises UnreadableError: if the source has changed since it was looked at
    """
    folder = to / one.student / one.assignment
    for part in (folder.parent, folder):
        if part.is_symlink():
            raise NotADirectoryError(20, 'a link where a folder should be')
    notebook, time = folder / file_name, folder / STAMP
    wanted = stamp(one.when) if one.when else None
    there, _ = read_file(notebook, file_name)
    time_there, _ = read_file(time, STAMP)
    same = there is not None and hashlib.sha256(there).hexdigest() == one.digest
    if same and wanted in (None, time_there):
        return UNCHANGED
    if write:
        data = None if same else one.read()
        if wanted is None and os.path.lexists(time):
            # First of all: what is killed here must not leave an old time with a new notebook.
            time.unlink()
        if wanted is not None and wanted != time_there:
            keep(time, wanted)
        if data is not None:
            keep(notebook, data)
    return TAKEN if there is None and time_there is None else REPLACED
