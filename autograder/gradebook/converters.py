"""
Run nbgrader's commands in this process, with the course's ``nbgrader_config.py``.

Each start of nbgrader's command line spends two seconds on imports; this module enters a whole
class in about the same time.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
import logging
from pathlib import Path
import tempfile
from typing import Any
import warnings

from nbgrader import api
from nbgrader.converters import (
    Autograde,
    BaseConverter,
    GenerateAssignment,
    GenerateFeedback,
    NbGraderException,
)
from nbgrader.coursedir import CourseDirectory
from sqlalchemy.exc import OperationalError, SQLAlchemyError
from traitlets.config import Config

from autograder.errors import from_os_error, GraderError, is_disk_full
from autograder.gradebook.database import address, database_failure, load_config, refusal
from autograder.gradebook.journal import refuse_incomplete
from autograder.layout import Layout

MAX_LINES = 6
"""Maximum number of nbgrader's log lines in an error: two lines each for three students."""


def generate(layout: Layout, assignment: str, release: Path, database: bool) -> None:
    """
    Write the student version of an assignment, as ``nbgrader generate_assignment`` does.

    :param release: folder that receives ``<assignment>/``
    :param database: whether to enter the assignment in the gradebook; if not, the output is
        deterministic
    :raises GraderError: with nbgrader's message if nbgrader fails
    """
    config = load_config(layout)
    config.CourseDirectory.release_directory = str(release)
    if not database:
        config.SaveCells.enabled = False
        config.GenerateAssignment.no_database = True
    _run(layout, assignment, f'generating {assignment}', config, _Generator)


def autograde(
    layout: Layout,
    assignment: str,
    submitted: Path,
    facts: Mapping[str, Mapping[str, Any]],
) -> None:
    """
    Enter results in the gradebook, as ``nbgrader autograde`` does.

    :param submitted: folder of rebuilt notebooks, ``<student>/<assignment>/<notebook>.ipynb``
    :param facts: what :mod:`autograder.gradebook.nbgrader_plugin` needs about each student: the
        ``result``, the ``name`` or an empty string, and ``same_work``, whether the answers are
        unchanged since the last entry
    :raises GraderError: with nbgrader's message, if some students failed; the others are recorded,
        unless the database or the disk failed
    """
    config = load_config(layout)
    config.CourseDirectory.submitted_directory = str(submitted)
    # These notebooks were rebuilt from the release: nbgrader need not repair and validate them
    # after every step, which takes most of its time.
    config.Autograde.exporter_class = 'nbconvert.exporters.NotebookExporter'
    config.Autograde.sanitize_preprocessors = ['nbgrader.preprocessors.ClearOutput']
    config.Exporter.optimistic_validation = True
    _run(layout, assignment, f'recording {assignment}', config, _Recorder, facts=facts)


def feedback(layout: Layout, assignment: str, students: Collection[str]) -> dict[str, bytes]:
    """
    Return the feedback page of each student, with the current marks of the gradebook.

    :returns: HTML by student; a student whose work nbgrader has not entered has none
    :raises GraderError: with nbgrader's message if nbgrader fails
    """
    config = load_config(layout)
    there = layout.work / 'autograded'
    students = [one for one in students if (there / one / assignment).is_dir()]
    with tempfile.TemporaryDirectory(prefix='feedback_', dir=layout.work) as folder:
        config.CourseDirectory.feedback_directory = folder
        doing = f'writing feedback for {assignment}'
        _run(layout, assignment, doing, config, _FeedbackWriter, students=students)
        return {
            path.parents[1].name: path.read_bytes()
            for path in Path(folder).glob(f'*/{assignment}/*.html')
        }


def _run(
    layout: Layout,
    assignment: str,
    doing: str,
    config: Config,
    kind: type[_StopOnDatabaseError],
    **attributes: Any,
) -> None:
    """Run a command of nbgrader with these attributes; ``doing`` describes it in messages."""
    config.CourseDirectory.assignment_id = assignment
    with _logged(doing) as log, _share_engine():
        coursedir = CourseDirectory(config=config, log=log)
        command = kind(coursedir=coursedir, config=config, log=log, force=True)
        for name, value in attributes.items():
            setattr(command, name, value)
        try:
            command.start()
        except NbGraderException as error:
            if isinstance(command.failure, OSError):
                raise from_os_error(command.failure, str(layout.work)) from error
            if isinstance(command.failure, SQLAlchemyError):
                raise refusal(layout, command.failure) from error
            raise


@contextmanager
def opened_gradebook(layout: Layout) -> Iterator[api.Gradebook]:
    """Yield nbgrader's gradebook; create it if there is none."""
    refuse_incomplete(layout)
    try:
        with _silence_nbgrader():
            with api.Gradebook(address(layout)) as gradebook:
                yield gradebook
    except (SQLAlchemyError, api.InvalidEntry) as error:
        if failure := database_failure(error):
            raise refusal(layout, failure) from error
        said = (str(error).strip().splitlines() or [type(error).__name__])[0]
        raise GraderError(
            f'nbgrader cannot use its gradebook: {said}.',
            'Try: close other programs that use it, then run the same command again. Finished '
            'runs are kept.',
        ) from error


@contextmanager
def _share_engine() -> Iterator[None]:
    """
    Make all of nbgrader's gradebook objects share one SQLAlchemy engine.

    nbgrader opens the gradebook seven times per submission, each time with a new engine.  Each
    engine compiles every query again and checks whether each of twenty tables exists.  This took
    half of the time needed to enter a submission.
    """
    make, tables = api.create_engine, api.Base.metadata
    api.create_engine = cache(make)
    tables.create_all = cache(tables.create_all)
    try:
        yield
    finally:
        api.create_engine = make
        del tables.create_all  # Restore the method of the class.


class _StopOnDatabaseError(BaseConverter):
    """
    An nbgrader command that stops at the first failure of the database or the disk.

    nbgrader itself continues with the next student, whose entry fails in the same way.  It stops
    only for an OperationalError, and then removes unfinished files.
    """

    failure: BaseException | None = None

    def init_assignment(self, assignment_id: str, student_id: str) -> None:
        """Create the entry of a submission in the gradebook."""
        with self._stopping():
            super().init_assignment(assignment_id, student_id)

    def convert_single_notebook(self, notebook_filename: str) -> None:
        """Enter a notebook in the gradebook and write it."""
        with self._stopping():
            super().convert_single_notebook(notebook_filename)

    @contextmanager
    def _stopping(self) -> Iterator[None]:
        try:
            yield
        except Exception as error:
            self.failure = error if is_disk_full(error) else database_failure(error)
            if self.failure is None:
                raise
            raise OperationalError(None, None, self.failure) from error


class _Generator(_StopOnDatabaseError, GenerateAssignment):
    """nbgrader's GenerateAssignment, which stops if the database or the disk fails."""


class _FeedbackWriter(_StopOnDatabaseError, GenerateFeedback):
    """nbgrader's GenerateFeedback for exactly the given students."""

    students: Collection[str]

    def init_notebooks(self) -> None:
        """List the notebooks of each student; nbgrader would read the ids as glob patterns."""
        self.assignments = {}
        for student in self.students:
            folder = Path(self._format_source(self.coursedir.assignment_id, student))
            self.assignments[str(folder)] = sorted(str(path) for path in folder.glob('*.ipynb'))


class _Recorder(_StopOnDatabaseError, Autograde):
    """nbgrader's Autograde for students whose results are known."""

    facts: Mapping[str, Mapping[str, Any]]

    def init_single_notebook_resources(self, notebook_filename: str) -> dict[str, Any]:
        """Add the facts that :mod:`autograder.gradebook.nbgrader_plugin` needs."""
        resources: dict[str, Any] = super().init_single_notebook_resources(notebook_filename)
        resources['nbgrader'].update(self.facts[resources['nbgrader']['student']])
        return resources


@contextmanager
def _silence_nbgrader() -> Iterator[None]:
    """Suppress SQLAlchemy's warnings and the tracebacks that nbgrader's gradebook logs."""
    gradebook = logging.getLogger('tornado.application')  # nbgrader.api uses this logger.
    before, gradebook.disabled = gradebook.disabled, True
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')  # SQLAlchemy warns about nbgrader's own queries.
            yield
    finally:
        gradebook.disabled = before


@contextmanager
def _logged(doing: str) -> Iterator[logging.Logger]:
    """Yield a logger for nbgrader, and raise nbgrader's failure as a GraderError."""
    lines: list[str] = []

    def note(record: logging.LogRecord) -> bool:
        """Store the last line of a message, which is the reason in a traceback; print nothing."""
        if record.levelno >= logging.ERROR:
            lines.extend(record.getMessage().strip().splitlines()[-1:])
        return False

    log = logging.Logger('nbgrader', logging.WARNING)
    log.addFilter(note)
    try:
        with _silence_nbgrader():
            yield log
    except (NbGraderException, RuntimeError) as error:
        said = [line for line in lines if 'traceback' not in line]
        if (more := len(said) - MAX_LINES) > 0:
            said[MAX_LINES:] = [f'(and {more} more lines)']
        raise GraderError(f'nbgrader failed while {doing}: {" ".join(said) or error}') from error
