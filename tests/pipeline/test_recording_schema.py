"""Test the published format of recordings; ``test_sample_class.py`` validates real ones."""

import json
from pathlib import Path
import re

from jsonschema import Draft202012Validator

from autograder import recording

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / 'docs' / 'recording.schema.json').read_text(encoding='utf-8'))
VALID = Draft202012Validator(SCHEMA)
KINDS = {
    kind['properties']['event']['const']
    for kind in SCHEMA['$defs'].values()
    if 'event' in kind.get('properties', {})
}


def invalid_lines(seen: recording.Recording) -> list[str]:
    """Return the schema's errors for the lines of a recording."""
    lines = seen.to_bytes().decode().splitlines()
    return [error.message for line in lines for error in VALID.iter_errors(json.loads(line))]


def test_the_schema_is_one():
    """The schema is valid in the draft that it names."""
    Draft202012Validator.check_schema(SCHEMA)


def test_it_has_the_events_that_the_probe_and_the_grader_write():
    """A new event must be added in both places."""
    source = ''.join(
        path.read_text(encoding='utf-8') for path in sorted(ROOT.glob('autograder/probe/*.py'))
    )
    written = set(re.findall(r"\.emit\(\s*'(\w+)'", source))

    assert written | {'process', 'again'} == KINDS


def test_an_unknown_event_and_an_unknown_field_are_refused():
    """Otherwise the schema would accept anything."""
    mark = {'event': 'mark', 'clock_ns': None, 'name': 'a'}

    assert VALID.is_valid(mark)
    assert not VALID.is_valid({**mark, 'event': 'marked'})
    assert not VALID.is_valid({**mark, 'expected': 5})
    assert not VALID.is_valid({'event': 'mark', 'clock_ns': None})
