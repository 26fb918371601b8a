"""
Run a saved node file on the grader's virtual clock, and return its messages and log lines.

As for ``check``, a child process runs the file, in a sandbox if one is available.
:func:`recorded_runs` returns recordings that are part of the course, without running anything.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from difflib import get_close_matches
import json
from pathlib import Path
import tempfile
from typing import Any

from autograder.commands import OK
from autograder.errors import ExamInvalid, UsageError
from autograder.exam import catalog
from autograder.recording import Recording
from autograder.simulated import Simulation
from autograder.simulation.documents import order_of, read_simulation
from roslab import run_command
from roslab.errors import not_written_yet, NotHereError, RoslabError
from roslab.output import say
from roslab.package_files import learner_package

_DEADLINE_S = 300.0


def simulate(
    node: str,
    *,
    seconds: float,
    inputs: Mapping[str, Sequence[tuple[float, Any]]] | None = None,
    late: Mapping[str, float] | None = None,
    arguments: Sequence[str] = (),
) -> Simulation:
    """
    Run a saved node file on a virtual clock, where an hour takes seconds.

    :param node: name in the ``%%node`` line of the node's cell
    :param seconds: virtual time from the start of the program [s]; at most one day
    :param inputs: messages to send, as ``{'topic': [(second, message), ...]}``, with messages or
        dicts of their fields; messages with the same second are sent in quick succession
    :param late: additional subscriptions that join later, as ``{'topic': second}``
    :param arguments: arguments of the program after ``--ros-args``, such as ``['-p',
        'rate_hz:=2.0']``
    :returns: messages and log lines with their times, for ``timeline`` and ``plot``. The result is
        cut off if the program has used too much processor time, or sent 20000 messages and log
        lines in total
    :raises RoslabError: if a file or topic does not exist, a time is invalid, or the run fails
    :raises NotImplementedError: if the program ended in an exercise that is not written yet
    """
    package = learner_package()
    saved = [one for one in package.files() if one.endswith('.py')]
    file = f'{str(node).removesuffix(".py")}.py'
    if file not in saved:
        near = get_close_matches(file, saved, n=1)
        hint = f'Did you mean {near[0].removesuffix(".py")!r}? ' if near else ''
        raise NotHereError(
            f'simulate({node!r}): no cell has saved {file}. {hint}'
            f'First run the cell that begins with %%node {file.removesuffix(".py")}.'
        )
    try:
        order = order_of(file, seconds, inputs, late, arguments)
    except UsageError as error:
        raise RoslabError(str(error)) from None
    with tempfile.TemporaryDirectory(prefix='simulate-') as folder:
        asked, done = Path(folder, 'order.json'), Path(folder, 'recording.jsonl')
        asked.write_text(json.dumps(asdict(order)), encoding='utf-8')
        outcome = run_command.run_grader(
            'autograder.simulation',
            *('--files', str(package.folder), '--order', str(asked), '--to', str(done)),
            text=f'Simulating {order.seconds:g} s of {file}',
            deadline_s=_DEADLINE_S,
        )
        if outcome.returncode != OK:
            raise RoslabError(_why(outcome))
        run = read_simulation(Recording.load(done))
    last = run.printed.rstrip().rpartition('\n')[2]
    if run.exit and last.startswith('NotImplementedError'):
        raise not_written_yet(f'Part of {file} is not written yet.')
    if run.exit:
        say(run.ended)
    return run


def recorded_runs(exam: str) -> list[Simulation]:
    """
    Return the recorded runs that an exam gives to a learner's check, as ``simulate`` returns runs.

    :param exam: name of the exam, as in ``check('NAME')``
    :raises RoslabError: if the exam does not exist or has no recorded runs
    """
    try:
        return list(catalog.load(exam, hidden=False).facts['runs'])
    except (ExamInvalid, KeyError) as error:
        why = str(error) if isinstance(error, ExamInvalid) else 'this exam has no recorded runs'
        raise RoslabError(f'recorded_runs({exam!r}): {why}.') from None


def _why(outcome: run_command.Outcome) -> str:
    """Return the error that the child printed last, or a description of how the child ended."""
    if outcome.returncode is None:
        return f'The simulation took more than {_DEADLINE_S:.0f} s of real time.'
    lines = outcome.output.strip().splitlines() or ['it printed nothing']
    return lines[-1].removeprefix('autograder: ')
