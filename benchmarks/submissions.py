"""The publishers of the sample class, as texts that each benchmark puts where it needs them."""

from __future__ import annotations

from collections.abc import Sequence
import json

from autograder.authoring.sample_class import compose
from autograder.layout import Layout
from autograder.submission.extract import answer_files

ASSIGNMENT = '07_temperature_monitor'
EXAM = 'temperature_publisher'
REFERENCE = 'pass__reference'
SIX = (
    REFERENCE,
    'pass__lambda_and_subclass',
    'fail__two_hertz',
    'fail__topic_typo',
    'fail__best_effort',
    'error__exception_in_callback',
)
"""Two right, four wrong in different ways, all of which a test in the kernel can see, too."""


def publishers(names: Sequence[str]) -> dict[str, str]:
    """
    Return the publisher file of each named sample submission.

    :param names: folders of ``tests/submissions/07_temperature_monitor``
    :raises SystemExit: if there is no such sample
    """
    layout = Layout.here()
    folder = layout.sample_class / ASSIGNMENT
    unknown = [name for name in names if not (folder / name / 'expected.json').is_file()]
    if unknown:
        known = ', '.join(sorted(path.name for path in folder.iterdir()))
        raise SystemExit(f'{", ".join(unknown)}: no such sample submission. Known: {known}.')
    texts = {}
    for name in names:
        notebook = json.loads(compose(layout, ASSIGNMENT, folder / name))
        texts[name] = answer_files(notebook)[EXAM].body
    return texts
