"""
Write results in the formats that GitHub reads.

* a workflow command per failed check, which GitHub shows at a file and line;
* a job summary in Markdown;
* the result that GitHub Classroom's reporter adds up, as Base64-encoded JSON.

Students wrote parts of the text, so it is escaped: a line of their output must not become a
workflow command, and no text may become markup.
"""

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
import html
import json
import re

from autograder.explaining.feedback import number, points_of, printable
from autograder.results import CheckResult, ExamResult, Verdict

LINE = re.compile(r'\b[Ll]ine (\d+)')
SIGNS = {Verdict.PASSED: 'passed', Verdict.FAILED: '**failed**', Verdict.NOT_RUN: 'not run'}


@dataclass(frozen=True)
class Checked:
    """
    The outcome of one exam of a repository.

    :param file: path of the notebook in the repository
    :param source: text of the answer cell, empty if it is missing
    :param attempted: whether the answer was written; otherwise nothing was run
    :param result: the exam's result; without a run, the checks have no points
    :param problems: what is wrong with the cells, one line each
    """

    file: str
    text: str
    source: str
    attempted: bool
    result: ExamResult
    problems: tuple[str, ...] = ()


def error_commands(found: Sequence[Checked]) -> Iterator[str]:
    """Yield a workflow command for each problem and each failed check of an attempted exercise."""
    for one in found:
        for problem in one.problems:
            yield _command(one, 1, one.result.exam, problem)
        for check in one.result.checks if one.attempted else ():
            if check.verdict is Verdict.FAILED:
                yield _command(one, _cell_line(check), check.title, _message(check))


def line_in_file(text: str, source: str, line: int) -> int:
    """
    Return the line of a notebook's file that contains a line of a cell.

    :param text: the file; notebooks have one JSON string per line of a cell
    :param line: line of the cell, from 1
    :returns: 1 if the cell is not found
    """
    wanted = source.splitlines(keepends=True)
    lines = [_string(one) for one in text.splitlines()]
    for start in range(len(lines) - len(wanted) + 1) if wanted else ():
        if lines[start : start + len(wanted)] == wanted:
            return start + min(max(line, 1), len(wanted))
    return 1


def summary(found: Sequence[Checked]) -> str:
    """Return the job summary in Markdown: points, and a row per check of attempted exercises."""
    points = sum(one.result.points for one in found if one.attempted)
    most = sum(one.result.max_points for one in found)
    parts = [f'# {number(points)} of {number(most)} points in the visible checks', '']
    for one in found:
        parts += [f'## {_safe(one.result.exam)}: {points_of(one.result)}', '']
        if not one.attempted:
            parts += [f'The answer in `{one.file}` is not written yet.', '']
            continue
        parts += ['| check | result | points | why |', '|---|---|---:|---|']
        for check in one.result.checks:
            why = _safe(_message(check)) if check.verdict is Verdict.FAILED else ''
            given = f'{SIGNS[check.verdict]} | {points_of(check)}'
            parts.append(f'| {_safe(check.title)} | {given} | {why} |')
        parts.append('')
    parts.append('A hidden exam with different inputs gives the points that count.')
    return '\n'.join(parts) + '\n'


def classroom_result(found: Sequence[Checked]) -> str:
    """Return the result that GitHub Classroom's reporter reads, as one line."""
    tests = [
        {
            'name': printable(f'{one.result.exam}: {check.title}'),
            'status': 'pass' if one.attempted and check.verdict is Verdict.PASSED else 'fail',
            'score': check.points if one.attempted else 0.0,
            'message': printable(_message(check)),
            'filename': one.file,
        }
        for one in found
        for check in one.result.checks
    ]
    data = {
        'version': 1,
        'status': 'pass' if all(test['status'] == 'pass' for test in tests) else 'fail',
        'max_score': sum(one.result.max_points for one in found),
        'tests': tests,
    }
    return base64.b64encode(json.dumps(data).encode()).decode()


def _cell_line(check: CheckResult) -> int:
    """Return the line of the cell that the cause or the observation names, or 1."""
    match = LINE.search(check.cause) or LINE.search(check.observed)
    return int(match[1]) if match else 1


def _message(check: CheckResult) -> str:
    facts = check.facts if check.verdict is Verdict.FAILED else {}
    return '\n'.join(f'{name}: {text}' for name, text in facts.items())


def _command(one: Checked, line: int, title: str, message: str) -> str:
    place = line_in_file(one.text, one.source, line)
    head = f'file={_property(one.file)},line={place},title={_property(title)}'
    return f'::error {head}::{_data(message)}'


def _data(text: str) -> str:
    """Return a string, escaped for a workflow command on one line."""
    text = printable(text).replace('%', '%25')
    return text.replace('\r', '%0D').replace('\n', '%0A')


def _property(text: str) -> str:
    return _data(text).replace(':', '%3A').replace(',', '%2C')


def _safe(text: str) -> str:
    """Return a string, escaped for one cell of a Markdown table."""
    plain = html.escape(printable(text), quote=False)
    marked = re.sub(r'([\\`*_{}\[\]()#+!|~@])', r'\\\1', plain)
    return marked.replace('\n', '<br>')


def _string(line: str) -> str | None:
    """Return the JSON string that a line of a notebook's file contains, or None."""
    text = line.strip().removesuffix(',')
    if not text.startswith('"'):
        return None
    try:
        return str(json.loads(text))
    except ValueError:
        return None
