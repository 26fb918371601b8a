"""Provide the publishers of the sample class as source text for the benchmarks."""

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
"""Two correct and four wrong submissions; a test in the kernel can detect all four mistakes."""


def publishers(names: Sequence[str]) -> dict[str, str]:
    """
    Return the publisher file of each named sample submission.

    :param names: folders of ``tests/submissions/07_temperature_monitor``
    :raises SystemExit: if a sample does not exist
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
