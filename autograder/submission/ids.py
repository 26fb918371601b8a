"""Convert a name to a unique student id that nbgrader and every file system accept."""

import hashlib
import re
import unicodedata

from autograder.submission.inbox import is_letter, is_student_id, MAX_NAME_CHARS

_DIGITS = 12
"""Hexadecimal digits of the digest: enough that the names of a class do not collide by chance."""
_REPLACED = re.compile(rf'.*--[0-9a-f]{{{_DIGITS}}}')


def named_id(text: str) -> str:
    """
    Return the student id for the name or the student id that an instructor gives.

    :func:`student_id` would replace even an id that it has created itself, because it cannot know
    that the text is not a name.
    """
    return text if is_student_id(text) and _REPLACED.fullmatch(text) else student_id(text)


def student_id(name: str) -> str:
    """
    Return a student id for a name: the name itself if it is a valid id.

    Letters of all alphabets are kept, with their combining characters.  If characters must be
    replaced, the id ends with a digest of the name.  So different names have different ids, and an
    id does not depend on the other students.

    :returns: empty if the name has no letter or digit
    """
    text = unicodedata.normalize('NFC', name)
    kept = ''.join(char if is_letter(char) or char in ' .@-' else '_' for char in text)
    kept = kept.strip(' ._-@')
    # Drop combining characters without their letter.
    while kept and unicodedata.category(kept[0])[0] == 'M':
        kept = kept[1:].lstrip(' ._-@')
    if not kept:
        return ''
    if is_student_id(text) and not _REPLACED.fullmatch(text):
        return text
    digest = hashlib.sha256(text.encode('utf-8', 'surrogatepass')).hexdigest()[:_DIGITS]
    return f'{kept[: MAX_NAME_CHARS - _DIGITS - 2].rstrip()}--{digest}'
