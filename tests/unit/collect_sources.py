"""
Sources of submissions in each platform's form, and the resulting files in ``submitted/``.

Other tests use ``laid``, which writes files, and ``configure``, which writes nbgrader's settings.
"""

from functools import partial
from itertools import count
import json
from pathlib import Path
import zipfile

import pytest

from autograder.collect import copy_notebooks as collecting
from autograder.collect import deliveries
from autograder.collect.recognise import recognise_platform
from autograder.layout import Layout
from autograder.submission.reading import opened

collect = partial(collecting.collect, trust_names=True)
"""All deliveries in these exchanges belong to the user who runs the tests."""

TALK, LISTEN, SPIN = '03_talk', '04_listen', '05_spin'


def notebook(*ids: str, text: str = 'x = 1') -> bytes:
    cells = [
        {
            'cell_type': 'code',
            'metadata': {'nbgrader': {'grade_id': one, 'solution': True}},
            'source': text,
        }
        for one in ids
    ]
    return json.dumps({'cells': cells, 'metadata': {}, 'nbformat': 4}).encode()


GOOD, OTHER = notebook('talker', 'talk_rate'), notebook('listener')
OWN = notebook(text='what I tried')
"""A student's own notes: a notebook without a cell of the course."""
DAMAGED = GOOD[:40]


@pytest.fixture
def layout(tmp_path) -> Layout:
    """Return a course with two assignments and one lesson without graded cells."""
    course = Layout(tmp_path / 'course')
    for name, data in ((TALK, GOOD), (LISTEN, OTHER), (SPIN, notebook())):
        folder = course.notebooks / name
        folder.mkdir(parents=True)
        (folder / f'{name[3:]}.ipynb').write_bytes(data)
    return course


@pytest.fixture
def here(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> Layout:
    """Return the course, which commands use."""
    monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: layout))
    return layout


@pytest.fixture
def gather(tmp_path: Path, layout: Layout):
    """Return a function that puts files into a new folder or zip, and collects them."""
    numbers = count()

    def gathered(files, how=laid, **options):
        source = how(tmp_path / f'source-{next(numbers)}', files)
        return collect(source, layout, layout.submitted, **options)

    return gathered


def configure(folder: Path, url: str, text: str = '') -> Layout:
    """Write nbgrader's settings for a course, with the address of its gradebook; return it."""
    settings = f'c = get_config()\nc.CourseDirectory.db_url = {url!r}\n{text}'
    (folder / 'nbgrader_config.py').write_text(settings, encoding='utf-8')
    return Layout(folder)


def packed(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def laid(folder: Path, files: dict[str, bytes]) -> Path:
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder


def limit(monkeypatch, **limits: int) -> None:
    """Lower the limits for the size of a source."""
    monkeypatch.setattr(deliveries, 'BOUNDS', deliveries.BOUNDS._replace(**limits))


def taken(layout: Layout) -> dict[str, bytes]:
    return {
        path.relative_to(layout.submitted).as_posix(): path.read_bytes()
        for path in sorted(layout.submitted.rglob('*'))
        if path.is_file()
    }


def table(rows) -> dict[tuple[str, str], str]:
    return {(row.student, row.place): row.done for row in rows}


def done(rows) -> list[tuple[str, str, str]]:
    return sorted((row.student, row.assignment, row.done) for row in rows)


def kind(source: Path) -> str:
    with opened(source, deliveries.BOUNDS) as found:
        return recognise_platform(found)


def notes(rows) -> dict[str, tuple[str, ...]]:
    return {row.place: row.notes for row in rows}


CANVAS = {
    'exampleann_1001_55001_talk.ipynb': notebook('talker', text='first'),
    'exampleann_1001_55077_talk-1.ipynb': notebook('talker', text='second'),
    'berg_LATE_1002_55002_talk.ipynb': GOOD,
    'chang_1003_55003_listen.ipynb': OTHER,
    'diaz_1004_55004_essay.pdf': b'%PDF',
    'evans_1005_55005_My work (2).ipynb': GOOD,
    'fox_1006_text.html': b'<html>',
}
MOODLE = {
    'Ann Example_311_assignsubmission_file/talk.ipynb': GOOD,
    'Bo Berg_312_assignsubmission_file/sub/talk (1).ipynb': GOOD,
    'Li Wei_313_assignsubmission_file/talk.ipynb': GOOD,
    'Li Wei_314_assignsubmission_file/talk.ipynb': GOOD,
    'Dee_315_assignsubmission_onlinetext/onlinetext.html': b'<p>hello',
}
METADATA = b"""---
submission_101:
  :submitters:
  - :name: Ann Example
    :sid: '1001'
    :email: ann@example.org
  :created_at: 2026-03-01 12:00:00.000000000 Z
  :score: 0.0
  :status: processed
submission_102:
  :submitters:
  - :name: Bo
    :sid:
    :email: bo@example.org
  - :name: Cy
    :sid: '1003'
  :created_at: 2026-03-02 05:00:00.000000000 -08:00
submission_103:
  :submitters: nobody
"""
GRADESCOPE = {
    'assignment_9_export/submission_metadata.yml': METADATA,
    'assignment_9_export/submission_101/talk.ipynb': GOOD,
    'assignment_9_export/submission_102/talk.ipynb': GOOD,
    'assignment_9_export/submission_103/talk.ipynb': GOOD,
}
AT_ONE, AT_TWO = '2026-03-01 12:00:00.123456 UTC', '2026-03-02 12:00:00.654321 UTC'
EXCHANGE = {
    f'c/inbound/ann+{TALK}+{AT_ONE}+q3rYx_-a/talk.ipynb': notebook('talker', text='1'),
    f'c/inbound/ann+{TALK}+{AT_TWO}+Zk09aaB1/talk.ipynb': notebook('talker', text='2'),
    f'c/inbound/ann+{TALK}+{AT_TWO}+Zk09aaB1/timestamp.txt': AT_TWO.encode(),
    f'c/inbound/ann+{TALK}+{AT_TWO}+Zk09aaB1/submission_secret.txt': b'5ec7e7',
    f'c/inbound/bob+{LISTEN}+{AT_TWO}/listen.ipynb': OTHER,
    f'c/outbound/{TALK}/talk.ipynb': GOOD,
}
REPOSITORIES = {
    'talk-ann/.git/config': b'[core]',
    f'talk-ann/notebooks/{TALK}/talk.ipynb': GOOD,
    'talk-bob/.git/HEAD': b'ref',
    'talk-bob/talk.ipynb': GOOD,
    'talk-bob/scratch.ipynb': b'{}',
    'talk-cho/.git/HEAD': b'ref',
    'talk-cho/README.md': b'nothing yet',
}
every_kind = pytest.mark.parametrize(
    ('files', 'expected'),
    [
        (CANVAS, 'canvas'),
        (MOODLE, 'moodle'),
        (GRADESCOPE, 'gradescope'),
        (EXCHANGE, 'exchange'),
        (REPOSITORIES, 'folder'),
    ],
    ids=['canvas', 'moodle', 'gradescope', 'exchange', 'repositories'],
)
