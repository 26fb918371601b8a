"""Print and save the common parts of all benchmarks: machine, figures and results file."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime, timezone
import hashlib
import json
import os
from pathlib import Path
import platform
import statistics
import subprocess
import sys
from typing import Any

from autograder.runs.version import made_with
from environment.ros import ros_environment

RESULTS = Path(__file__).parent / 'results'
NOT_COMPARED = ('timing', 'recording', 'pictures')
"""Parts of results that differ from run to run, or are compared separately."""
Seen = Mapping[str, Counter[str]]
"""How often each outcome of the same work was seen, by the name of the work."""
BURN = 'import os\nparent = os.getppid()\nwhile os.getppid() == parent: pass'
"""A busy loop that ends when the benchmark ends, even if the benchmark is killed."""


def machine() -> dict[str, Any]:
    """Return the facts on which figures depend; they identify no person, host or folder."""
    return {
        'date': datetime.now(timezone.utc).strftime('%Y-%m-%d %H:%M UTC'),
        'processor': _processor(),
        'cores': len(os.sched_getaffinity(0)),
        'system': f'{platform.system()} {platform.release().split("-")[0]}',
        'python': platform.python_version(),
        'ros': f'Jazzy, rclpy {made_with().get("rclpy", "?")} ({ros_environment().kind})',
        'grader': _grader(),
        'load_at_start': load(),
    }


def _grader() -> str:
    """Return a digest of the grader's files: equal digests mean the same grader was measured."""
    state = hashlib.sha256()
    for path in sorted((RESULTS.parents[1] / 'autograder').rglob('*')):
        if path.suffix in ('.py', '.xml', '.bpf') and '_work' not in path.parts:
            state.update(path.read_bytes())
    return state.hexdigest()[:12]


def load() -> float:
    """Return the load average of the last minute."""
    return round(os.getloadavg()[0], 1)


def _processor() -> str:
    for line in Path('/proc/cpuinfo').read_text(encoding='utf-8', errors='replace').splitlines():
        name, _, value = line.partition(':')
        if name.strip() in ('model name', 'Model'):
            return ' '.join(value.split())
    return platform.machine()


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
    Print the figures of a benchmark, and write those of a full one to ``results/<name>.json``.

    :param facts: from :func:`machine`, taken before the first measurement
    :param full: whether the benchmark ran at full size; otherwise the figures are only printed
    """
    data = {'benchmark': name, 'machine': {**facts, 'load_at_end': load()}, **figures}
    text = json.dumps(data, indent=2, ensure_ascii=False)
    print(text)
    if facts['grader'] != _grader():
        print('Not written: the files of the grader changed during the benchmark. Run it again.')
    elif not full:
        print('Not written: this was not the full benchmark.')
    else:
        path = RESULTS / f'{name}.json'
        path.write_text(f'{text}\n', encoding='utf-8')
        print(f'Written to benchmarks/results/{path.name}')


@contextmanager
def busy(count: int) -> Iterator[None]:
    """Keep some CPUs busy inside the ``with`` block."""
    burners = [subprocess.Popen([sys.executable, '-S', '-c', BURN]) for _ in range(count)]
    try:
        yield
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


def compared(data: Any) -> Any:
    """Return a result, as JSON types, without :data:`NOT_COMPARED`."""
    if isinstance(data, dict):
        return {name: compared(one) for name, one in data.items() if name not in NOT_COMPARED}
    return [compared(one) for one in data] if isinstance(data, (list, tuple)) else data


def differing(seen: Seen) -> dict[str, dict[str, int]]:
    """Return the work with more than one outcome."""
    return {name: dict(found.most_common()) for name, found in seen.items() if len(found) > 1}
