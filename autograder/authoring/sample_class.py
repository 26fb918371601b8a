"""
The bundled sample class: submissions named by outcome and cause, built from small files.

``tests/submissions/<assignment>/<outcome>__<cause>/`` holds only the files in which a submission
differs from the reference solution, without their magic line, and ``expected.json``.  A file is
either complete, or ``NAME.diff`` with its changes, see :func:`changed`::

    {"about": "...", "notebook": "...", "answers": {grade_id: text}, "points": {exam: points},
     "failed": {exam: {check: cause_id}}, "in_class": true}

A submission with ``"in_class": false`` is only for tests and is not in the class that ``make
grade`` grades in a new clone.  ``notebook`` names the kind of damage to the whole notebook, see
:data:`DAMAGES`; ``answers`` has answers to questions, which are too short for files.
"""

from collections.abc import Iterator
import json
from pathlib import Path
import shutil
import tempfile
from typing import Any

from autograder.errors import GraderError
from autograder.exam.inputs import fingerprint_file
from autograder.files import refuse_existing, write_atomically
from autograder.layout import Layout
from autograder.results import first_of
from autograder.submission.cells import body_of
from autograder.submission.inbox import students_in
from autograder.submission.notebook import answer_cells, Notebook, read_release, StudentCell
from autograder.submission.reading import read_file
from autograder.submission.submission import answer_files, rebuild

DAMAGES = ('', 'renamed_cell', 'duplicated_cell', 'truncated', 'not_a_notebook')
"""Kinds of damage to a whole notebook; ``not_a_notebook`` replaces it with a web page."""
NOT_A_NOTEBOOK = (
    b'<!DOCTYPE html>\n<html><head><title>JupyterLab</title></head><body></body></html>\n'
)
DIFF = '.diff'
UNTOUCHED = 'untouched'
"""Value of ``notebook`` for the unchanged release, without the answers of the reference."""


def damaged(notebook: Notebook, damage: str) -> bytes:
    """Return a notebook as JupyterLab saves it, with one of the :data:`DAMAGES`."""
    if damage == 'not_a_notebook':
        return NOT_A_NOTEBOOK
    if damage in ('renamed_cell', 'duplicated_cell'):
        cells, answers = notebook['cells'], answer_cells(notebook).values()
        cell = next(cell for cell in answers if cell['source'].startswith('%%node'))
        if damage == 'renamed_cell':  # as if a copy had replaced the cell
            cell['metadata']['nbgrader']['grade_id'] += '-copy1'
        else:
            source = f'{cell["source"].splitlines()[0]}\n# second try, not finished\n'
            cells.insert(cells.index(cell) + 1, {**cell, 'source': source})
    data = (json.dumps(notebook, indent=1, ensure_ascii=False) + '\n').encode()
    # Truncate the file as a full disk would.
    return data[: len(data) * 2 // 3] if damage == 'truncated' else data


def samples(layout: Layout, assignment: str, everything: bool = False) -> Iterator[Path]:
    """Yield the folders of an assignment's samples; ``everything`` includes those for tests."""
    folder = layout.sample_class / assignment
    if folder.is_dir():
        for path in sorted(folder.iterdir()):
            if (path / 'expected.json').is_file() and (
                everything or expected_of(path).get('in_class', True)
            ):
                yield path


def expected_of(sample: Path) -> dict[str, Any]:
    """Return the content of a sample submission's ``expected.json``."""
    data = json.loads((sample / 'expected.json').read_text(encoding='utf-8'))
    if not isinstance(data, dict):
        raise GraderError(f'{sample.name}/expected.json: expected a JSON object.')
    return data


def own_files(sample: Path) -> dict[str, Path]:
    """Return the files in which a sample differs from the reference, by their paths."""
    found: dict[str, Path] = {}
    for path in sorted(path for path in sample.rglob('*') if path.is_file()):
        name = path.relative_to(sample).as_posix().removesuffix(DIFF)
        if name in found:
            raise GraderError(f'{sample.name}: both {name} and {name}{DIFF}.', 'Delete one.')
        if name != 'expected.json' and '__pycache__' not in name:
            found[name] = path
    return found


def changed(text: str, diff: str) -> str:
    """
    Return a file of the reference solution with the changes of a sample.

    A diff has no line numbers, so it still fits if other parts of the solution change::

        @@
        -PERIOD_S = 1.0
        +PERIOD_S = 0.5

    :param diff: changes, each after a line ``@@``; their lines begin with ``-`` (old), ``+`` (new)
        or a space (both)
    :raises GraderError: if the old lines of a change do not occur exactly once
    """
    before, *changes = f'\n{diff}'.removesuffix('\n').split('\n@@\n')
    if before or not changes:
        raise GraderError('A diff does not begin with a line @@.')
    text = f'\n{text}\n'
    for change in changes:
        lines = change.split('\n')
        old, new = (
            ''.join(f'\n{line[1:]}' for line in lines if line[:1] != skipped) + '\n'
            for skipped in '+-'
        )
        if (count := text.count(old)) != 1:
            raise GraderError(
                f'The old lines of a change occur {count} times in the solution:{old}',
                'Correct these lines, or add neighbouring lines so that they occur once.',
            )
        text = text.replace(old, new)
    return text[1:-1]


def compose(layout: Layout, assignment: str, sample: Path) -> bytes:
    """Return the notebook file of a sample; GraderError if the sample has a mistake."""
    release = read_release(layout.release(assignment))
    damage = str(expected_of(sample).get('notebook', ''))
    if damage == UNTOUCHED:
        from autograder.gradebook import converters

        # Do not read the release folder: a user may have solved the lesson there.
        with tempfile.TemporaryDirectory(prefix='release-') as folder:
            converters.generate(layout, assignment, Path(folder), database=False)
            return Path(folder, assignment, layout.release(assignment).name).read_bytes()
    if damage not in DAMAGES:
        raise GraderError(
            f'{sample.name}/expected.json: unknown value {damage!r} for "notebook".',
            f'Known: {", ".join(sorted({*DAMAGES, UNTOUCHED}))}.',
        )
    notebook, _ = rebuild(release, _student_cells(layout, assignment, sample, release))
    return damaged(notebook, damage)


def _student_cells(
    layout: Layout, assignment: str, sample: Path, release: Notebook
) -> list[StudentCell]:
    """Return the cells of the reference solution with the changes of a sample."""
    solution = layout.solutions / assignment / layout.release(assignment).name
    solved = answer_cells(read_release(solution))
    answers = {name: body_of(cell['source']).rstrip('\n') for name, cell in solved.items()}
    files = {file.path: (name, file) for name, file in answer_files(release).items()}
    own, short = own_files(sample), expected_of(sample).get('answers', {})
    for name in [*(own.keys() - files.keys()), *(short.keys() - answers.keys())]:
        known = ', '.join([*files, *(answers.keys() - {name for name, _ in files.values()})])
        raise GraderError(f'{sample.name}: no such answer: {name}.', f'Known: {known}.')
    for name, path in own.items():
        grade_id, file = files[name]
        text = path.read_text(encoding='utf-8')
        if path.suffix == DIFF:
            answers[grade_id] = changed(answers[grade_id], text)
        else:
            answers[grade_id] = f'%%{file.kind} {file.name}\n{text}'.rstrip('\n')
    for grade_id, text in short.items():
        magic_line, _, _ = answers[grade_id].partition('\n')
        answers[grade_id] = f'{magic_line}\n{text}'
    return [StudentCell(name, solved[name]['cell_type'], text) for name, text in answers.items()]


def write_sample_class(layout: Layout, folder: Path, force: bool = False) -> int:
    """
    Write all sample submissions as a class of students.

    :param folder: folder that receives ``<outcome>__<cause>/<assignment>/<notebook>.ipynb``
    :param force: whether changed notebooks may be replaced
    :raises GraderError: if this copy of the course has no sample submissions, the folder is that
        of a real class, or a notebook in it was changed; then nothing is written
    """
    made = {
        folder / sample.name / assignment / layout.release(assignment).name: compose(
            layout, assignment, sample
        )
        for assignment in layout.assignments()
        for sample in samples(layout, assignment)
    }
    if not made:
        raise GraderError(
            'This copy of the course has no sample class.',
            f'Put submissions into {folder} as STUDENT/ASSIGNMENT/NOTEBOOK.ipynb.',
        )
    graded = folder.is_dir() and folder.resolve() == layout.submitted.resolve()
    there = students_in(folder, layout.assignments()) if graded else ()
    if others := sorted({*there} - {path.parts[-3] for path in made}):
        raise GraderError(
            f'{folder}: this folder contains other students: {first_of(others, 3)}.',
            'Try: --to with a new folder',
        )
    refuse_existing(
        (path for path, data in made.items() if read_file(path, path.name)[0] != data), force
    )
    for path, data in made.items():
        write_atomically(path, data)
    return len(made)


def remove_sample_class(layout: Layout) -> int:
    """
    Remove the sample students before the first real class; return their number.

    If nobody else was graded, the class may have a different course secret.
    """
    from autograder.gradebook.journal import read_notes
    from autograder.gradebook.record import remove_entries

    names = {path.name for one in layout.assignments() for path in samples(layout, one, True)}
    gone = set()
    for above in (layout.submitted, layout.work / 'autograded', layout.work / 'feedback'):
        for name in sorted(names):
            if (above / name).is_dir() and not (above / name).is_symlink():
                shutil.rmtree(above / name)
                gone.add(name)
    if gone:
        remove_entries(layout, names)
        if not any(read_notes(layout, one) for one in layout.assignments()):
            fingerprint_file(layout).unlink(missing_ok=True)
    return len(gone)
