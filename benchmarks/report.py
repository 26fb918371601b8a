"""Print and save what all benchmarks have in common: machine, plain tables, file of results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
import hashlib
import importlib.metadata
import json
import os
from pathlib import Path
import platform
import statistics
from typing import Any

RESULTS = Path(__file__).parent / 'results'


def machine() -> dict[str, Any]:
    """Return the facts on which figures depend; they identify no person, host or folder."""
    return {
        'date': datetime.now(timezone.utc).strftime('%Y-%m-%d %H:%M UTC'),
        'processor': _processor(),
        'cores': len(os.sched_getaffinity(0)),
        'system': f'{platform.system()} {platform.release().split("-")[0]}',
        'python': platform.python_version(),
        'ros': _ros(),
        'grader': _grader(),
        'load_at_start': _load(),
    }


def _grader() -> str:
    """Return a digest of the grader's files: equal digests mean the same grader was measured."""
    state = hashlib.sha256()
    for path in sorted((RESULTS.parents[1] / 'autograder').rglob('*')):
        if path.suffix in ('.py', '.xml', '.bpf') and '_work' not in path.parts:
            state.update(path.read_bytes())
    return state.hexdigest()[:12]


def _load() -> float:
    """Return the load average of the last minute."""
    return round(os.getloadavg()[0], 1)


def _processor() -> str:
    for line in Path('/proc/cpuinfo').read_text(encoding='utf-8', errors='replace').splitlines():
        name, _, value = line.partition(':')
        if name.strip() in ('model name', 'Model'):
            return ' '.join(value.split())
    return platform.machine()


def _ros() -> str:
    """Return which ROS 2 is used, and the version of rclpy."""
    from environment.ros import ros_environment

    kind = ros_environment().kind
    for package in ('ros-rclpy', 'rclpy'):
        try:
            return f'Jazzy, rclpy {importlib.metadata.version(package)} ({kind})'
        except importlib.metadata.PackageNotFoundError:
            continue
    return f'Jazzy ({kind})'


def print_machine(facts: Mapping[str, Any]) -> None:
    """
    Print the machine and software that produced the figures.

    :param facts: from :func:`machine`
    """
    print(f'{facts["processor"]}, {facts["cores"]} cores, {facts["system"]}')
    print(f'Python {facts["python"]}, ROS 2 {facts["ros"]}, {facts["date"]}')
    print(f'load at start {facts["load_at_start"]}\n')


def print_table(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """
    Print rows below headings: the first column left-aligned, the others right-aligned.

    :param rows: floats are printed with at most three decimals, None as an empty cell
    """
    texts = [[str(heading) for heading in headings]]
    texts += [[_text(value) for value in row] for row in rows]
    widths = [max(len(row[column]) for row in texts) for column in range(len(headings))]
    texts.insert(1, ['-' * width for width in widths])
    for row in texts:
        first = row[0].ljust(widths[0])
        rest = [text.rjust(width) for text, width in zip(row[1:], widths[1:])]
        print('  '.join([first, *rest]).rstrip())
    print()


def _text(value: object) -> str:
    if value is None:
        return ''
    if isinstance(value, bool):
        return 'yes' if value else 'NO'
    if isinstance(value, float):
        return f'{value:.1f}' if abs(value) >= 10 else f'{value:.3f}'
    return str(value)


def spread(seconds: Sequence[float]) -> dict[str, float]:
    """
    Return the median and the range of some measurements.

    :param seconds: one or more measurements [s]
    """
    return {
        'median': round(statistics.median(seconds), 4),
        'least': round(min(seconds), 4),
        'most': round(max(seconds), 4),
        'count': len(seconds),
    }


def save(name: str, facts: Mapping[str, Any], figures: Mapping[str, Any], *, full: bool) -> None:
    """
    Write the figures of a full benchmark to ``results/<name>.json``.

    :param facts: from :func:`machine`, taken before the first measurement
    :param full: whether the benchmark ran at full size, as for the README
    """
    if facts['grader'] != _grader():
        print('Not written: the files of the grader changed meanwhile. Run this again.')
        return
    if not full:
        print('Not written: this was not the full benchmark.')
        return
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f'{name}.json'
    data = {'benchmark': name, 'machine': {**facts, 'load_at_end': _load()}, **figures}
    path.write_text(json.dumps(data, indent=2, ensure_ascii=False) + '\n', encoding='utf-8')
    print(f'Written to benchmarks/results/{path.name}')
