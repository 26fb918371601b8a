"""The published schema of recordings, and what in a recording does not follow it."""

import json
from pathlib import Path

from jsonschema import Draft202012Validator

from autograder.recording import Recording

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / 'docs' / 'recording.schema.json').read_text(encoding='utf-8'))
VALID = Draft202012Validator(SCHEMA)


def invalid_lines(recording: Recording) -> list[str]:
    """Return what the schema refuses in the lines of a recording."""
    lines = recording.to_bytes().decode().splitlines()
    return [error.message for line in lines for error in VALID.iter_errors(json.loads(line))]
