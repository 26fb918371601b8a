"""
Where the parts of a course lie: the one place that knows the folder names.

``nbgrader_config.py`` at the root says the same to nbgrader; a test compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from autograder.errors import GraderError


@dataclass(frozen=True)
class Layout:
    """
    The folders of one course.

    :param root: the folder with ``solutions/``, ``notebooks/`` and ``nbgrader_config.py``
    """

    root: Path

    @classmethod
    def here(cls) -> Layout:
        """Return the course this package lies in."""
        return cls(Path(__file__).resolve().parent.parent)

    @property
    def solutions(self) -> Path:
        """Return the folder of the single source of every notebook."""
        return self.root / 'solutions'

    @property
    def notebooks(self) -> Path:
        """Return the folder of the generated notebooks that students receive."""
        return self.root / 'notebooks'

    @property
    def work(self) -> Path:
        """Return the folder of everything that grading writes; git ignores it."""
        return self.root / 'autograder' / '_work'

    @property
    def submitted(self) -> Path:
        """Return the folder with ``<student>/<assignment>/<notebook>.ipynb``."""
        return self.work / 'submitted'

    @property
    def people(self) -> Path:
        """Return the file with the names of people, by student id."""
        return self.work / 'people.json'

    @property
    def namesakes(self) -> Path:
        """Return the file with the names that two people have, and people's numbers in Moodle."""
        return self.work / 'namesakes.json'

    @property
    def not_collected(self) -> Path:
        """Return the file with the deliveries that could not be collected."""
        return self.work / 'not_collected.json'

    @property
    def recordings(self) -> Path:
        """Return the folder of recordings, named by the digest of what was run."""
        return self.work / 'recordings'

    @property
    def reports(self) -> Path:
        """Return the folder of the HTML reports."""
        return self.work / 'reports'

    @property
    def sample_class(self) -> Path:
        """Return the folder of the bundled example submissions."""
        return self.root / 'tests' / 'submissions'

    def assignments(self) -> tuple[str, ...]:
        """Return the names of all released assignments, sorted."""
        if not self.notebooks.is_dir():
            return ()
        found = (path.parent.name for path in self.notebooks.glob('*/*.ipynb'))
        return tuple(sorted(set(found)))

    def assignment_named(self, name: str) -> str:
        """
        Return the assignment that is meant.

        :param name: with or without its number, ``07_temperature_monitor`` or
            ``temperature_monitor``
        :raises GraderError: if there is none of that name, with the nearest one
        """
        known = self.assignments()
        for one in known:
            if name == one or one.endswith(f'_{name}'):
                return one
        close = get_close_matches(name, known, n=1, cutoff=0.3)
        raise GraderError(
            f'{name}: there is no such assignment.',
            f'Did you mean {close[0]}?' if close else f'Known: {", ".join(known) or "none"}.',
        )

    def release(self, assignment: str) -> Path:
        """
        Return the released notebook of an assignment.

        :raises FileNotFoundError: if the assignment has no notebook, with the fix
        """
        found = sorted((self.notebooks / assignment).glob('*.ipynb'))
        if not found:
            raise FileNotFoundError(
                f'notebooks/{assignment}/ has no released notebook. Generate it with: make release'
            )
        return found[0]
