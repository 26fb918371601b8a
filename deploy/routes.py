"""
Execute the installation routes, and record in environment.md when and where each one worked.

    python -m deploy.routes NAME...    execute routes, as root, in a clone of the last commit
    python -m deploy.routes            write the table again

``routes.json`` holds the rows of the table. Executing a route sets the date and the result of its
row; a route that fails changes nothing. The container route needs podman.
"""

from collections.abc import Callable, Mapping, Sequence
import json
import os
from pathlib import Path
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from typing import Any

import psutil

from autograder.files import json_bytes, write_atomically
from deploy.hub.first_lesson import LessonFailed, teach
from environment.places import PROJECT

ROWS = Path(__file__).with_suffix('.json')
PAGE = PROJECT / 'environment.md'
BEGIN, END = '<!-- written by deploy.routes -->\n', '<!-- end of the routes -->\n'
HEAD = '| NAME | route | system | you type | executed | result |\n|---|---|---|---|---|---|\n'

NOBODY = 65534
SYSTEM = {'PATH': '/usr/sbin:/usr/bin:/sbin:/bin', 'HOME': '/root', 'LANG': 'C.UTF-8'}
SYSTEM['DEBIAN_FRONTEND'] = 'noninteractive'
WIDE = {'COLUMNS': '200'}
"""A terminal width at which no line of a report wraps."""


HUB_SCRIPT = """\
mount -t proc proc /proc
set -m
exec 3<&0 </dev/null
{before}
{start} &
wait $! || echo "make has ended with code $?"
read -r _ <&3
"""
"""
Bubblewrap covers parts of ``/proc``, so without a new mount, the hub's users could not start a
sandbox.  With ``set -m``, the last command is a process group, so Ctrl-C reaches all of it.
"""
OPENED = r'^Open (\S+) and log in as (\w+), (\w+)'
ENDED = 'make has ended with code'
STOPPED_S = 90.0


class RouteFailed(Exception):
    """Raised when a route does not lead to the expected result."""


def run(folder: Path, *command: str | Path, cwd: Path | None = None, **more: str) -> str:
    """
    Run a command and return its output, which is also appended to ``log`` in the folder.

    :param more: further environment variables
    :raises RouteFailed: if it ends with an exit code other than 0
    """
    with Path(folder, 'log').open('a+', encoding='utf-8') as log:
        begin = log.seek(0, os.SEEK_END)
        environ = {**os.environ, **WIDE, **more}
        done = subprocess.run(
            command, cwd=cwd, env=environ, stdin=subprocess.DEVNULL, stdout=log, stderr=log
        )
        log.seek(begin)
        output = log.read()
    if done.returncode:
        last = '\n'.join(output.splitlines()[-5:])
        raise RouteFailed(f'{command[0]} ended with code {done.returncode}:\n{last}')
    return output


def copy_of_project(folder: Path, inside: str = '.') -> Path:
    """Clone the project into ``course`` in a folder, and return its path."""
    course = folder / inside / 'course'
    run(folder, 'git', 'clone', '--quiet', '--no-hardlinks', PROJECT, course)
    return course


def make_grade(folder: Path, *before: str | Path, **more: Any) -> str:
    """
    Grade the sample class and return the result; parameters are those of :func:`run`.

    One sample submission is unreadable and for review; ``make grade`` succeeds nevertheless.
    """
    return sample_class_result(run(folder, *before, 'make', 'grade', **more))


def sample_class_result(report: str) -> str:
    """
    Return the result of grading the sample class, from what ``make grade`` printed.

    :raises RouteFailed: if submissions are missing, a correct one lost points or isolation is weak
    """
    graded = sum(map(int, re.findall(r'^(\d+) submissions in ', report, re.M)))
    sample = re.search(r'so the (\d+) example submissions', report)
    modes = set(re.findall(r'isolation\s+(\S+?)[.;]', report))
    right = re.findall(r'^│ (pass__\S+) +│ +([\d.]+) of +(\d+) │', report, re.M)
    wrong = [name for name, points, of in right if float(points) < int(of)]
    if not sample or graded != int(sample[1]):
        raise RouteFailed(f'expected the sample class, but {graded} submissions were graded')
    if wrong or not right:
        raise RouteFailed(f'expected full points for {wrong[0] if wrong else "pass__..."}')
    if len(modes) != 1 or not modes < {'bwrap-user', 'bwrap-root'}:
        raise RouteFailed(f'expected full isolation, got {", ".join(sorted(modes)) or "none"}')
    return f'{graded} submissions, `{modes.pop()}`'


# -- routes --------------------------------------------------------------------------------


def this_machine(folder: Path) -> str:
    """Grade the sample class as root."""
    return make_grade(folder, cwd=copy_of_project(folder))


def plain_user(folder: Path) -> str:
    """Grade the sample class as the user nobody."""
    course = copy_of_project(folder)
    run(folder, 'chown', '-R', f'{NOBODY}:{NOBODY}', course)
    become = ('setpriv', f'--reuid={NOBODY}', f'--regid={NOBODY}', '--clear-groups')
    return make_grade(folder, *become, cwd=course, HOME=str(course))


def new_system(suite: str, areas: str = 'main') -> Callable[[Path], str]:
    """
    Return a route that grades the sample class on a new system where only make is installed.

    :param suite: name of the release for debootstrap
    :param areas: components of its archive, separated by commas
    """

    def execute(folder: Path) -> str:
        root = debootstrap(folder, suite, f'--components={areas}', '--include=make')
        copy_of_project(folder, 'root')
        return make_grade(folder, *inside(root, '/course'))

    return execute


def inside(root: Path, cwd: str) -> list[str]:
    """Return the command prefix that runs a command in a new system on this machine's network."""
    environ, names = {**SYSTEM, **WIDE}, ('/etc/resolv.conf', '/etc/hosts')
    binds = dict(zip(names, names, strict=True))
    # Behind a proxy, pip and npm need the proxy's certificate authority.
    if authority := os.environ.get('PIP_CERT'):
        binds[authority] = '/run/authority'
        environ |= dict.fromkeys(('PIP_CERT', 'NODE_EXTRA_CA_CERTS'), '/run/authority')
    words = ['bwrap', '--bind', str(root), '/', '--proc', '/proc', '--dev', '/dev']
    words += ['--perms', '1777', '--tmpfs', '/dev/shm']  # as on a booted system
    words += ['--cap-add', 'ALL', '--unshare-pid', '--die-with-parent', '--chdir', cwd]
    words += [word for pair in binds.items() for word in ('--ro-bind', *pair)]
    words += ['--clearenv']
    return words + [word for pair in environ.items() for word in ('--setenv', *pair)]


def debootstrap(folder: Path, suite: str, *options: str) -> Path:
    """Install a minimal system into ``root`` in a folder, and return its path."""
    root = folder / 'root'
    run(folder, 'debootstrap', '--variant=minbase', *options, suite, root)
    return root


def container(folder: Path) -> str:
    """Build the image on a new Debian 12; grade the sample class with compose.yaml's options."""
    course = copy_of_project(folder)
    root = debootstrap(folder, 'bookworm')
    run(folder, 'tar', '-C', root, '-cf', folder / 'base.tar', '.')
    run(folder, 'podman', 'import', folder / 'base.tar', 'ros2-course-base')
    run(
        *(folder, 'podman', 'build', '--format', 'docker', '--build-arg', 'BASE=ros2-course-base'),
        *('-f', 'deploy/container/Dockerfile', '-t', 'ros2-course', '.'),
        cwd=course,
    )
    seccomp = course / 'deploy' / 'container' / 'grader.json'
    security = ('no-new-privileges', f'seccomp={seccomp}', 'unmask=ALL')
    return make_grade(
        *(folder, 'podman', 'run', '--rm', '--network=none', '--shm-size=512m', '--cap-drop=ALL'),
        *(*(f'--security-opt={one}' for one in security), '--env=COLUMNS', 'ros2-course'),
    )


def hub(folder: Path) -> str:
    """Click through a class on a hub in headless Chromium, and keep the screenshots."""
    course, pictures = copy_of_project(folder), Path('docs', 'pictures')
    run(folder, 'make', 'test-hub', cwd=course)
    shutil.copytree(course / pictures, PROJECT / pictures, dirs_exist_ok=True)
    return last_match(r'(\d+ passed)', folder)


def new_hub(suite: str, areas: str = 'main') -> Callable[[Path], str]:
    """
    Return a route that runs the commands in ``docs/hub.md`` on a new system and teaches a lesson.

    :param suite: name of the release for debootstrap
    :param areas: components of its archive, separated by commas
    """

    def execute(folder: Path) -> str:
        root = debootstrap(folder, suite, f'--components={areas}')
        page = copy_of_project(folder, 'root') / 'docs' / 'hub.md'
        *before, start = commands_of(page.read_text(encoding='utf-8'))
        edit = f"sed -i 's/^port = .*/port = {first_of_three_free_ports()}/' /etc/ros2_hub.toml"
        script = HUB_SCRIPT.format(before='\n'.join([*before, edit]), start=start)
        command = [*inside(root, '/root'), 'bash', '-exc', script]
        pipe = subprocess.PIPE
        signal.signal(signal.SIGINT, signal.default_int_handler)  # no program may inherit SIG_IGN
        with subprocess.Popen(
            command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True
        ) as system:
            try:
                address, instructor, student = printed(folder, system, OPENED)
                points = teach(address, instructor, student)
                stop_hub(folder, system)
            finally:
                system.kill()  # this also ends all processes in the new system
        return f'feedback returned: {points}'

    return execute


def commands_of(page: str) -> list[str]:
    """Return the commands of the first block of ``docs/hub.md``, for a project in ``/course``."""
    block = page.partition('```console\n')[2].partition('```')[0]
    typed = re.findall(r'^# (.+?)(?:  +#.*)?$', block, re.M)
    return [command.replace('PROJECT', '/course') for command in typed]


def printed(folder: Path, system: subprocess.Popen[str], pattern: str) -> tuple[str, ...]:
    """Copy output to the log up to a line that matches, and return the groups of the pattern."""
    last: list[str] = []
    with Path(folder, 'log').open('a', encoding='utf-8') as log:
        for line in system.stdout or ():
            log.write(line)
            log.flush()
            last = [*last[-4:], line]
            if found := re.search(pattern, line):
                return found.groups()
            if ENDED in line:
                break
    raise RouteFailed(f'expected {pattern!r} in the output:\n{"".join(last)}')


def stop_hub(folder: Path, system: subprocess.Popen[str]) -> None:
    """
    Stop a hub as Ctrl-C does.

    :raises RouteFailed: if a process is left
    """
    inner = psutil.Process(system.pid).children(recursive=True)
    make = next(one for one in inner if one.name() == 'make')
    os.killpg(os.getpgid(make.pid), signal.SIGINT)
    printed(folder, system, ENDED)
    inner = psutil.Process(system.pid).children(recursive=True)
    _, left = psutil.wait_procs(
        [one for one in inner if one.name() not in ('bwrap', 'bash')], timeout=STOPPED_S
    )
    if left:
        raise RouteFailed(f'the hub has ended, but {left[0]} is still running')


def first_of_three_free_ports() -> int:
    """Return a port that is free on 127.0.0.1, as are the next two."""
    for port in random.sample(range(18000, 19000, 3), 100):  # other hubs look for ports too
        with socket.socket() as one, socket.socket() as two, socket.socket() as three:
            try:
                for offset, probe in enumerate((one, two, three)):
                    probe.bind(('127.0.0.1', port + offset))
            except OSError:
                continue
            return port
    raise RouteFailed('no three free ports from 18000 to 18999')


def see_it(folder: Path) -> str:
    """Run the program that needs only uv, with an empty cache."""
    cache = str(folder / 'cache')
    run(folder, 'uv', 'run', 'see_it.py', cwd=copy_of_project(folder), UV_CACHE_DIR=cache)
    return last_match(r'(\d+ messages went from one node to another)', folder)


def last_match(pattern: str, folder: Path) -> str:
    """Return the last match of a pattern's group in the log."""
    found = re.findall(pattern, (folder / 'log').read_text(encoding='utf-8'))
    if not found:
        raise RouteFailed(f'expected {pattern!r} in the output')
    return str(found[-1])


ROUTES: dict[str, Callable[[Path], str]] = {
    'this-machine': this_machine,
    'plain-user': plain_user,
    'debian-12': new_system('bookworm'),
    'debian-13': new_system('trixie'),
    'ubuntu-24.04': new_system('noble', 'main,universe'),
    'container': container,
    'hub': hub,
    'hub-debian-12': new_hub('bookworm'),
    'hub-ubuntu-24.04': new_hub('noble', 'main,universe'),
    'see-it': see_it,
}


# -- table ---------------------------------------------------------------------------------


def table(rows: Sequence[Mapping[str, str]]) -> str:
    """Return the Markdown table of rows; a row without a date was never executed."""
    lines = [
        f'| {row["name"]} | {row["route"]} | {row["system"]} | {row["type"]} | '
        f'{row["date"] or "**untried**"} | {row["result"]} |\n'
        for row in rows
    ]
    return HEAD + ''.join(lines)


def write(name: str = '', **changes: str) -> None:
    """Change the row of a route, and write all rows to both files."""
    rows = json.loads(ROWS.read_text(encoding='utf-8'))
    for row in rows:
        row.update(changes if row['name'] == name else {})
    write_atomically(ROWS, json_bytes(rows))
    before, rest = PAGE.read_text(encoding='utf-8').split(BEGIN)
    write_atomically(PAGE, f'{before}{BEGIN}{table(rows)}{END}{rest.split(END)[1]}'.encode())


def execute(name: str) -> dict[str, str]:
    """
    Execute a route, and return the date and the result for its row.

    :raises RouteFailed: if it does not work; the folder with the log is then kept
    """
    folder = Path(tempfile.mkdtemp(prefix=f'route-{name}-'))
    folder.chmod(0o755)
    print(f'{name}: log in {folder}/log', flush=True)
    begin = time.monotonic()
    result = ROUTES[name](folder)
    minutes, seconds = divmod(round(time.monotonic() - begin), 60)
    shutil.rmtree(folder)
    today = time.strftime('%Y-%m-%d', time.gmtime())
    return {'date': today, 'result': f'{result}, {minutes} min {seconds} s'}


def main(names: Sequence[str]) -> int:
    """Execute routes, write their rows, and return the exit code."""
    if unknown := set(names) - set(ROUTES):
        print(f'{unknown.pop()}: no such route. Try one of: {", ".join(ROUTES)}', file=sys.stderr)
        return 2
    write()
    for name in names:
        try:
            write(name, **execute(name))
        except (RouteFailed, LessonFailed, OSError) as error:
            print(f'{name}: {error}', file=sys.stderr)
            return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
