"""
Plug-ins for nbgrader's release and collect on a machine that students share with instructors.

``nbgrader_config.py`` names them, so formgrader's buttons and ``nbgrader collect`` use them.  If a
user hands in work under another user's name, nbgrader itself only warns, and it follows links with
the instructor's permissions; ``collect`` refuses both.
"""

from pathlib import Path

from nbgrader.exchange.default import ExchangeCollect, ExchangeReleaseAssignment
from traitlets import Dict

from autograder.classroom.course_lock import lock_course
from autograder.collect.copy_notebooks import collect
from autograder.collect.deliveries import LEFT
from autograder.collect.platforms import EXCHANGE, INBOUND
from autograder.errors import GraderError
from autograder.explaining.feedback import printable
from autograder.gradebook.nbgrader_plugin import course_of
from environment.exchange import protect


class ReleaseProtected(ExchangeReleaseAssignment):
    """Release an assignment, and set the sticky bit on the folder of deliveries."""

    def init_dest(self) -> None:
        """Create the folders of the exchange and protect them."""
        super().init_dest()
        protect(Path(self.root))


class CollectFromOwners(ExchangeCollect):
    """Collect an assignment by the same rules as the command ``collect``."""

    owners = Dict(
        help='Name of the system user by student id, where the two differ. Only the value in the '
        "course's nbgrader_config.py counts.",
    ).tag(config=True)

    def init_src(self) -> None:
        """Find the course, and refuse options that the command does not have."""
        self.course_path = str(Path(self.root, self.coursedir.course_id))
        if not Path(self.course_path, INBOUND).is_dir():
            self.fail(f'{self.course_path}: there is no course with released assignments.')
        if self.before_duedate or self.coursedir.student_id not in ('', '*'):
            self.fail(
                'Deliveries of one student, or before the due date, cannot be collected alone. '
                'Leave out --student and --before-duedate; late work is marked as late.'
            )

    def copy_files(self) -> None:
        """Collect the deliveries and log each row of the table."""
        layout = course_of(self.config)
        try:
            with lock_course(layout, 'collect'):
                rows = collect(
                    Path(self.course_path),
                    layout,
                    layout.submitted,
                    self.coursedir.assignment_id,
                    EXCHANGE,
                    trust_names=not self.check_owner,
                )
        except GraderError as error:
            self.fail(str(error))
        for row in rows:
            log = self.log.error if row.done == LEFT else self.log.info
            log(printable(f'{row.place}: {"; ".join((row.done, *row.notes))}'))
