"""The start of a node file, tested without ROS."""

from pathlib import Path
import subprocess
import sys

from autograder.sandboxes.sandbox import HERE

LAUNCHER = Path(HERE, 'inside', 'run_node.py')


def started(path: Path, gate: bytes = b'x') -> subprocess.CompletedProcess[bytes]:
    """Run a file as the sandbox does."""
    return subprocess.run(
        [sys.executable, str(LAUNCHER), str(path)], input=gate, capture_output=True, check=False
    )


def test_nothing_runs_before_the_gate_is_opened(tmp_path):
    """If the input ends without the byte, the grader has ended."""
    path = tmp_path / 'node.py'
    path.write_text('print("ran")', encoding='utf-8')

    done = started(path, gate=b'')

    assert done.stdout == b''
    assert done.returncode == 1
