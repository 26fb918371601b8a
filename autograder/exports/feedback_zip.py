"""
Pack feedback pages under the file names that Canvas and Moodle expect in an upload.

Canvas (``infer_comment_context_from_filename`` of an assignment) reads the first two numbers of
a name: the user's and the attachment's.  It ignores names whose last part begins with ``link``.
Moodle (``mod/assign/feedback/file/importziplib.php``) reads the participant's number and the type
of the submission.  The names of downloaded submissions contain these values.  Both platforms
ignore all other files in the zip.
"""

from collections.abc import Mapping
from pathlib import PurePath
import re

from autograder.classroom.collected import Work
from autograder.files import safe_name, zip_bytes

PAGE = 'feedback.html'
MOODLE = re.compile(r'.+?_\d+_assignsubmission_file')


def name_in_zip(student: str, work: Work | None) -> str:
    """Return a page's name for its platform, else its path in a folder with the student's id."""
    if work and work.kind == 'canvas':
        return f'{PurePath(work.place).stem}_{PAGE}'
    if work and work.kind == 'moodle' and (match := MOODLE.match(work.place)):
        return f'{match[0]}_{PAGE}'
    return f'{safe_name(student)}/{PAGE}'


def feedback_zip(pages: Mapping[str, bytes], works: Mapping[str, Work]) -> bytes:
    """Return the zip file of the pages; both mappings have student ids as keys."""
    return zip_bytes(
        {name_in_zip(one, works.get(one)): (page, 0o644) for one, page in pages.items()}
    )
