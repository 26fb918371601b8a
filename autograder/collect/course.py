"""Grade ids and file names of the assignments, which identify a notebook."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
import re

from autograder.collect.times import due_dates, DueDates
from autograder.layout import Layout
from autograder.submission.notebook import grade_ids, read_notebook, read_release

# Suffixes that browsers, Canvas and Jupyter add to a name that already exists.
_COPY = re.compile(r'( ?\(\d+\)|-\d+| - Copy|-Copy\d+)+(?=\.ipynb$)')

_NUMBER = re.compile(r'^\d+[_-]')


def _plain(text: str) -> str:
    """Return a name in lower case, with hyphens instead of underscores, for comparisons."""
    return text.replace('_', '-').lower()


@dataclass
class Course:
    """The assignments of a course; their files are read on first use."""

    layout: Layout

    @cached_property
    def assignments(self) -> tuple[str, ...]:
        """Return the names of all assignments."""
        return self.layout.assignments()

    @cached_property
    def file_names(self) -> Mapping[str, str]:
        """Return the file name of each assignment's notebook."""
        return {name: self.layout.release(name).name for name in self.assignments}

    @cached_property
    def cells(self) -> Mapping[str, frozenset[str]]:
        """Return the grade ids of every released notebook, by assignment."""
        return {
            name: grade_ids(read_release(self.layout.release(name))) for name in self.assignments
        }

    @cached_property
    def due(self) -> DueDates:
        """Return the due dates in the gradebook."""
        return due_dates(self.layout)

    def of_file(self, name: str) -> str:
        """Return the assignment whose notebook has this name, ignoring suffixes like ``(1)``."""
        plain = _COPY.sub('', name)
        found = [one for one, file in self.file_names.items() if file in (name, plain)]
        return found[0] if len(found) == 1 else ''

    def named(self, parts: Sequence[str]) -> str:
        """Return the assignment that a path names, by its file or else by a folder."""
        folders = [part for part in parts[:-1] if part in self.assignments]
        return self.of_file(parts[-1]) or (folders[-1] if folders else '')

    def beginning(self, name: str) -> str:
        """Return the assignment and separator with which a repository's name begins, or ''."""
        forms = (form for one in self.assignments for form in (one, _NUMBER.sub('', one)))
        fitting = (one for one in forms if _plain(name).startswith(_plain(f'{one}-')))
        begins = (name[: len(one) + 1] for one in fitting)
        return max((one for one in begins if one != name), key=len, default='')

    def shared(self, data: bytes) -> dict[str, int]:
        """Return the number of grade ids in a notebook, by assignment; zeros are left out."""
        cells, _ = read_notebook(data, '')
        ids = {cell.grade_id for cell in cells or ()} - {''}
        return {name: len(ids & theirs) for name, theirs in self.cells.items() if ids & theirs}
