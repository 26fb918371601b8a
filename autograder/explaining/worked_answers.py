"""
Encode and read the worked answers of a lesson, one file in the students' copy.

The file is encoded so that learners do not read it by accident.  It is not secret: anyone can
decode it.  The release includes it only on request.
"""

from base64 import b64decode, encodebytes
from collections.abc import Mapping
import json
from pathlib import Path
import zlib

from autograder.errors import GraderError

FOLDER = 'answers'
"""Folder in the students' copy with one file per lesson."""
ABOUT = (
    b'# Worked answers of a lesson, encoded but not secret. answer(...) in a notebook shows them.'
)


def encoded(answers: Mapping[str, str]) -> bytes:
    """Return the content of a file with worked answers: texts of answer cells, by exam."""
    return ABOUT + b'\n' + encodebytes(zlib.compress(json.dumps(answers).encode()))


def read_answers(path: Path) -> dict[str, str]:
    """
    Return the worked answers of a lesson, by exam; empty if there is no file.

    :raises GraderError: if the file cannot be read or decoded
    """
    try:
        lines = path.read_bytes().partition(b'\n')[2]
        return dict(json.loads(zlib.decompress(b64decode(lines))))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, TypeError, zlib.error) as error:
        raise GraderError(
            f'{path}: this file does not contain worked answers: {error}.',
            'Try: copy it again from the files of the course',
        ) from error
