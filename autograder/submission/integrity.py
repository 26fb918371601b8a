"""
Report to the instructor how the cells of a submitted notebook differ from the release.

These differences do not change a grade, because the grader uses only the texts of answers (see
:mod:`autograder.submission.submission`).  nbgrader's checksums ignore tags, and are wrong for
every cell whose text is generated at release; this module compares cells with the release itself.
It ignores data that editors add (outputs, ids, folding, timing), so normal use of a notebook
causes no report.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from autograder.submission.notebook import by_grade_id, MARKS, marks_of, StudentCell

MOST_LINES = 20


def changes(release: Mapping[str, Any], cells: Sequence[StudentCell]) -> tuple[str, ...]:
    """
    Return how cells with a grade id differ from the release, one line per difference.

    :param release: the notebook that students received
    :param cells: all cells of the submitted notebook
    """
    by_id = by_grade_id(cells)
    lines: list[str] = []
    for released in release['cells']:
        if grade_id := marks_of(released).get('grade_id'):
            lines += _about(released, grade_id, by_id.pop(grade_id, []))
    lines += [
        f'the release has no cell with the grade id {name[:60]!r}'
        for name in sorted(by_id)
        if name
    ]
    more = len(lines) - MOST_LINES
    return (*lines[:MOST_LINES], *([f'{more} more differences from the release'] * (more > 0)))


def _about(
    released: dict[str, Any], grade_id: str, copies: Sequence[StudentCell]
) -> Iterator[str]:
    """Yield the differences of one cell of the release."""
    marks = marks_of(released)
    answer = bool(marks.get('solution'))
    name = f'{"answer" if answer else "locked"} cell {grade_id}'
    if not copies:
        yield f'{name} is missing'
        return
    if len(copies) > 1:
        yield f'{name} occurs {len(copies)} times'
    wanted = {key: marks[key] for key in MARKS if marks.get(key) is not None}
    for cell in copies[:1]:
        if not answer and cell.source.strip() != released['source'].strip():
            yield f'{name} has a different text'
        if cell.cell_type != released['cell_type']:
            yield f'{name} is a {cell.cell_type[:20]!r} cell'
        for key, value in wanted.items():
            if cell.marks.get(key) != value:
                yield f'{name} has a different value of {key}'
        tags = released['metadata'].get('tags', [])
        if not answer and sorted(cell.tags) != sorted(tags):
            yield f'{name} has the tags {", ".join(cell.tags)[:80] or "removed"!r}'
