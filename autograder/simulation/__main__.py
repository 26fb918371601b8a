"""
Run a node file on the virtual clock; ``simulate(...)`` in a notebook starts this program.

    python -m autograder.simulation --files DIR --order FILE --to FILE

This program judges nothing, so it is not a command of ``python -m autograder``.
"""

import argparse
from collections.abc import Sequence
import json
from pathlib import Path
import sys

from autograder.commands import OK, USAGE
from autograder.commands.check import REFUSALS, refuse, sandbox_for
from autograder.simulation.documents import Input, Order
from autograder.simulation.run import record
from autograder.submission.package import read_package


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code."""
    parser = argparse.ArgumentParser(prog='python -m autograder.simulation')
    parser.add_argument('--files', type=Path, required=True, help='folder of the package')
    parser.add_argument(
        '--order', type=Path, required=True, help='JSON file that says what to run'
    )
    parser.add_argument('--to', type=Path, required=True, help='file for the recording')
    chosen = parser.parse_args(arguments)
    try:
        given = json.loads(chosen.order.read_text(encoding='utf-8'))
        order = Order(**{**given, 'inputs': [Input(**one) for one in given['inputs']]})
        recording = record(order, read_package(chosen.files), sandbox_for(visible=True))
        recording.save(chosen.to)
    except REFUSALS as error:
        refuse(error, as_json=False)
        return USAGE
    return OK


if __name__ == '__main__':
    sys.exit(main())
