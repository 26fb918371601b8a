"""
Plug-ins for nbgrader's release and collect on a machine that students share with instructors.

``nbgrader_config.py`` names them, so formgrader's buttons and ``nbgrader collect`` use them.  If a
user hands in work under another user's name, nbgrader itself only warns; the plug-ins refuse it.
"""

from pathlib import Path
import tempfile
from typing import Any

from nbgrader.exchange.default import ExchangeCollect, ExchangeReleaseAssignment
from traitlets import Dict

from autograder.collect.owners import owner_doubt
from autograder.collect.source.deliveries import BOUNDS
from autograder.submission.tree import opened
from environment.exchange import protect

COPY_MODE = 0o755
"""File mode of a collected folder; in the exchange, every user can write to the folder."""


class ReleaseProtected(ExchangeReleaseAssignment):
    """Release an assignment, and set the sticky bit on the folder of deliveries."""

    def init_dest(self) -> None:
        """Create the folders of the exchange and protect them."""
        super().init_dest()
        protect(Path(self.root))


class CollectFromOwners(ExchangeCollect):
    """Collect only deliveries whose owner is the student in the name of the folder."""

    src_records: list[dict[str, Any]]

    owners = Dict(
        help='Name of the system user by student id, where the two differ.',
    ).tag(config=True)

    def init_src(self) -> None:
        """Find the newest delivery of each student among those that the student owns."""
        super().init_src()
        self.src_records = [one for one in self.src_records if not one['doubt']]

    def _path_to_record(self, path: str) -> dict[str, Any]:
        record: dict[str, Any] = super()._path_to_record(path)
        doubt = self._doubt(Path(path), record['username']) if self.check_owner else ''
        record['doubt'] = doubt
        if doubt:
            self.log.error('%s: not collected: %s', record['filename'], doubt)
            # nbgrader collects the newest delivery of each user.  Give a refused delivery a
            # different user name, so that a later forgery cannot hide the student's work.
            record['username'] = f'not collected: {record["filename"]}'
        return record

    def _doubt(self, folder: Path, student: str) -> str:
        inside = [folder, *folder.rglob('*')]
        if any(path.is_symlink() for path in inside):
            return f'handed in as {student!r}, but it contains a symbolic link'
        return owner_doubt(student, {path.lstat().st_uid for path in inside}, self.owners)

    def copy_files(self) -> None:
        """Copy the deliveries that were accepted."""
        self.check_owner = False  # nbgrader's own check ignores the setting ``owners``.
        super().copy_files()

    def do_copy(self, src: str, dest: str, log: Any = None) -> None:
        """
        Copy one delivery so that only the instructor can write to it.

        nbgrader would follow a link that replaces a file after :meth:`_doubt` has looked at it.
        """
        with tempfile.TemporaryDirectory() as folder, opened(Path(src), BOUNDS) as tree:
            for file in tree.files:
                path = Path(folder, *file.parts)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(file.read())
            super().do_copy(folder, dest, log)
        Path(dest).chmod(COPY_MODE)
