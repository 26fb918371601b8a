"""Test both programs as a user starts them: output, exit codes, signals."""

from collections.abc import Callable, Iterator
import os
from pathlib import Path
import signal
import subprocess
import threading

from ament_index_python.packages import get_package_prefix, get_package_share_directory
import pytest

DEADLINE_S = 20.0
PACKAGE = 'temp_monitor_pkg'

Start = Callable[..., subprocess.Popen]


@pytest.fixture
def start(domain_id: int) -> Iterator[Start]:
    """
    Return a function that starts one of the package's executables.

    A guard ends all running programs at the deadline, so that no test can hang.

    :param domain_id: domain of the test
    :returns: the function
    """
    processes: list[subprocess.Popen] = []
    guard = threading.Timer(DEADLINE_S, lambda: [process.kill() for process in processes])
    guard.start()

    def start_executable(name: str, *arguments: str) -> subprocess.Popen:
        environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain_id)}
        command = [str(Path(get_package_prefix(PACKAGE), 'lib', PACKAGE, name)), *arguments]
        process = subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        processes.append(process)
        return process

    yield start_executable
    guard.cancel()
    for process in processes:
        process.kill()
        process.wait()
        process.stdout.close()


def wait_for_line(process: subprocess.Popen, text: str) -> str:
    """Return the first line of output that contains the text; the guard limits the wait."""
    seen = []
    for line in process.stdout:
        seen.append(line)
        if text in line:
            return line
    raise AssertionError(f'the output ended without {text!r}:\n{"".join(seen)}')


@pytest.mark.parametrize('stop', [signal.SIGINT, signal.SIGTERM])
def test_both_programs_talk_and_stop_cleanly(start: Start, stop: signal.Signals) -> None:
    """Both programs print readings and warnings, and exit with code 0 on either signal."""
    config = Path(get_package_share_directory(PACKAGE), 'config', 'quick_fahrenheit.yaml')
    publisher = start('temp_publisher', '--ros-args', '--params-file', str(config))
    subscriber = start('temp_subscriber', '--ros-args', '-p', 'threshold_c:=22.0')

    assert 'Fahrenheit' in wait_for_line(publisher, '[temperature_publisher]')
    assert 'Fahrenheit' in wait_for_line(subscriber, '[temperature_subscriber]')
    assert 'above the threshold of 22.00' in wait_for_line(subscriber, 'WARN')
    for process in (publisher, subscriber):
        process.send_signal(stop)
        output, _ = process.communicate()
        assert 'Traceback' not in output
        assert process.returncode == 0


@pytest.mark.parametrize(
    ('name', 'setting', 'reason'),
    [
        ('temp_publisher', 'rate_hz:=-1.0', 'Min: 0.1'),
        ('temp_publisher', 'unit:=Kelvin', 'one of Celsius, Fahrenheit'),
        ('temp_subscriber', 'threshold_c:=30', 'DOUBLE'),
    ],
)
def test_bad_parameter_ends_with_one_clear_line(
    start: Start, name: str, setting: str, reason: str
) -> None:
    """An invalid value on the command line gives one line, no traceback and exit code 2."""
    process = start(name, '--ros-args', '-p', setting)
    output, _ = process.communicate()

    assert process.returncode == 2
    assert len(output.splitlines()) == 1
    assert 'FATAL' in output
    assert reason in output
