"""
Implement ``ros2 launch`` for XML launch files, with the tags that a first launch file needs.

As with the real command, log lines always appear, but printed text only with
``output="screen"``.
"""

import argparse
from collections.abc import Iterator, Sequence
import os
from pathlib import Path
import re
import signal
import subprocess
from threading import Thread
from typing import NamedTuple
from xml.etree import ElementTree

from roslab.ros2.cli import option, verb
from roslab.ros2.pkg import executable_of, PackageMissingError, prefix_of

TAGS = {
    'launch': (),
    'node': ('pkg', 'exec', 'name', 'namespace', 'output'),
    'param': ('from', 'name', 'value'),
    'remap': ('from', 'to'),
}
"""The supported tags and their attributes."""
PATIENCE_S = 5.0
"""Maximum time for programs to end after Ctrl-C [s]."""
_SHARE = re.compile(r'\$\(find-pkg-share ([a-z][a-z0-9_]*)\)')


class Start(NamedTuple):
    """A program that a launch file starts; ``screen`` says whether to show the text it prints."""

    name: str
    command: tuple[str, ...]
    screen: bool


@verb(
    'launch',
    option('package_name', help='Name of the ROS package, or path of a launch file'),
    option('launch_file_name', nargs='?', help='Name of the launch file'),
)
def launch(args: argparse.Namespace) -> None:
    """Start all programs of a launch file and wait until they end."""
    starts = list(read(find(args.package_name, args.launch_file_name)))
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    running = [_started(one) for one in starts]
    watching = [Thread(target=_watch, args=both) for both in zip(starts, running)]
    for thread in watching:
        thread.start()
    try:
        for process in running:
            process.wait()
    except KeyboardInterrupt:
        print('[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)', flush=True)
        _end(running)
    for thread in watching:
        thread.join()


def find(package: str, name: str | None) -> Path:
    """Return a launch file, by path or by package and name; RuntimeError if it is missing."""
    if name is None:
        if Path(package).is_file():
            return Path(package)
        raise RuntimeError(f"file '{package}' was not found")
    try:
        share = prefix_of(package) / 'share' / package
    except PackageMissingError:
        raise RuntimeError(f"Package '{package}' not found") from None
    found = sorted(share.rglob(name))
    if not found:
        raise RuntimeError(
            f"file '{name}' was not found in the share directory of package '{package}' which is "
            f"at '{share}'"
        )
    return found[0]


def read(path: Path) -> Iterator[Start]:
    """
    Yield the programs that a launch file starts.

    :raises RuntimeError: if the file is not XML, or needs a full installation of ROS 2
    """
    try:
        root = ElementTree.fromstring(path.read_text(encoding='utf-8'))
    except ElementTree.ParseError as error:
        raise RuntimeError(
            f"{path.name}: {error}. The course's own ros2 reads only XML launch files."
        ) from None
    for tag in root.iter():
        unknown = [name for name in tag.attrib if name not in TAGS.get(tag.tag, ())]
        if tag.tag not in TAGS or unknown:
            what = f'{tag.tag} {unknown[0]}' if tag.tag in TAGS else tag.tag
            raise RuntimeError(f'{path.name}: <{what}> belongs to a full installation of ROS 2.')
    for number, node in enumerate(root.iter('node'), 1):
        yield _start_of(node, number)


def _start_of(node: ElementTree.Element, number: int) -> Start:
    package, name = node.get('pkg', ''), node.get('exec', '')
    program = executable_of(package, name)
    if program is None:
        raise RuntimeError(f"executable '{name}' not found in the package '{package}'")
    space = node.get('namespace', '')
    words = [f'__node:={node.get("name")}'] if node.get('name') else []
    words += [f'__ns:=/{space.lstrip("/")}'] if space else []
    words += [f'{one.get("from")}:={one.get("to")}' for one in node.iter('remap')]
    given = [word for one in words for word in ('-r', one)]
    for param in node.iter('param'):
        if (source := param.get('from')) is None:
            given += ['-p', f'{param.get("name")}:={param.get("value")}']
        else:
            path = _SHARE.sub(lambda found: f'{prefix_of(found[1])}/share/{found[1]}', source)
            given += ['--params-file', path]
    arguments = ['--ros-args', *given] if given else []
    screen = node.get('output') == 'screen'
    return Start(f'{name}-{number}', (str(program), *arguments), screen)


def _started(start: Start) -> subprocess.Popen[str]:
    """Start a program in a separate session, so that it gets Ctrl-C once, from this process."""
    process = subprocess.Popen(
        start.command,
        env={'RCUTILS_LOGGING_BUFFERED_STREAM': '1', **os.environ},  # send each line at once
        stdout=subprocess.PIPE if start.screen else subprocess.DEVNULL,
        stderr=subprocess.STDOUT if start.screen else subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    print(f'[INFO] [{start.name}]: process started with pid [{process.pid}]', flush=True)
    return process


def _watch(start: Start, process: subprocess.Popen[str]) -> None:
    """Show the output of a program, and its exit code at the end."""
    for line in (process.stdout if start.screen else process.stderr) or ():
        print(f'[{start.name}] {line}', end='', flush=True)
    code, pid = process.wait(), process.pid
    if code == 0:
        print(f'[INFO] [{start.name}]: process has finished cleanly [pid {pid}]', flush=True)
    else:
        died = f"process has died [pid {pid}, exit code {code}, cmd '{' '.join(start.command)}']."
        print(f'[ERROR] [{start.name}]: {died}', flush=True)


def _end(running: Sequence[subprocess.Popen[str]]) -> None:
    """Interrupt all programs once, then kill those that do not end in time."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for process in running:
        process.send_signal(signal.SIGINT)
    for process in running:
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
