"""Recordings follow their published format: every event of every exam, and nothing more."""

from __future__ import annotations

import json
from pathlib import Path
import re

from jsonschema import Draft202012Validator
import pytest

from autograder import recording
from autograder.commands import run as quick_look
from autograder.exam import catalog
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.sandboxes.choose import strongest

LAYOUT = Layout.here()
ROOT = LAYOUT.root
SCHEMA = json.loads((ROOT / 'docs' / 'recording.schema.json').read_text(encoding='utf-8'))
VALID = Draft202012Validator(SCHEMA)
RUN = [
    pytest.param(assignment, exam.name, id=exam.name)
    for assignment in LAYOUT.assignments()
    for exam in catalog.for_assignment(assignment, hidden=False)
    if exam.scenario.program
]
KINDS = {
    kind['properties']['event']['const']
    for kind in SCHEMA['$defs'].values()
    if 'event' in kind.get('properties', {})
}


def test_the_schema_is_one():
    """Of the draft that it names."""
    Draft202012Validator.check_schema(SCHEMA)


def test_it_has_the_events_that_the_probe_writes_and_the_words_that_describe_them():
    """A new event is in all three places."""
    source = ''.join(
        path.read_text(encoding='utf-8') for path in sorted(ROOT.glob('autograder/probe/*.py'))
    )
    written = set(re.findall(r"\.emit\(\s*'(\w+)'", source))

    assert written | {'process'} == KINDS
    for kind in KINDS:
        assert f'``{kind}``' in recording.__doc__, kind


def test_an_unknown_event_and_an_unknown_field_are_refused():
    """Else the schema would say nothing."""
    mark = {'event': 'mark', 'clock_ns': None, 'name': 'a'}

    assert VALID.is_valid(mark)
    assert not VALID.is_valid({**mark, 'event': 'marked'})
    assert not VALID.is_valid({**mark, 'expected': 5})
    assert not VALID.is_valid({'event': 'mark', 'clock_ns': None})


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize(('assignment', 'name'), RUN)
def test_every_line_of_a_real_recording_is_valid(assignment, name, tmp_path: Path):
    """Of the reference solution, in the exam's visible form."""
    exam = catalog.load(name, hidden=False)
    source = LAYOUT.solutions / assignment / LAYOUT.release(assignment).name
    looks = quick_look.looks(source, [exam], LAYOUT)

    ((_, result),) = quick_look.quick_look(looks, strongest(), tmp_path)

    assert result.points == result.max_points
    kept = Recording.load(tmp_path / name / result.recording)
    assert kept.header['files']
    for line in kept.to_bytes().decode().splitlines():
        wrong = [error.message for error in VALID.iter_errors(json.loads(line))]
        assert wrong == [], line
