"""
Run a hostile program in one isolation mode, and print what it reached, as JSON.

Usage: mode_world.py MODE FOLDER [linger | held | run].  The folder contains files that the program
must not read.  This is a separate script, because some modes need a plain user and some need root.
With ``linger`` it prints a line while the hostile program and its daemon run, and waits to be
killed; with ``held`` it does so before a program is released; with ``run`` it prints lines while
a probe watches an endless program.
"""

import json
import os
from pathlib import Path
import socket
import sys

from autograder.exam import catalog
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.runs.observe import observe
from autograder.runs.program import submission_folder
from autograder.sandboxes import choose, sandbox
from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.forked import INSIDE

HOSTILE = """
import ctypes, json, os, signal, socket, subprocess, sys

facts = json.load(open('/submission/facts.json' if os.path.exists('/submission/facts.json')
                       else os.path.join(os.path.dirname(__file__), 'facts.json')))


def attempt(name, what):
    try:
        print(name, 'REACHED' if what() is not False else 'nothing', flush=True)
    except OSError as error:
        print(name, 'refused', flush=True)


for path in facts['secrets']:
    attempt('read', lambda: open(path).read(1))
attempt('environ', lambda: open(f"/proc/{facts['grader']}/environ").read(1))
attempt('memory', lambda: open(f"/proc/{facts['grader']}/mem", 'rb').read(1))
attempt('write', lambda: open(os.path.join(facts['folder'], 'mine'), 'w'))
attempt('cut', lambda: os.truncate(facts['secrets'][-1], 0))
attempt('link', lambda: os.symlink(facts['secrets'][0], os.path.join(facts['folder'], 'l')))
attempt('signal', lambda: os.kill(facts['grader'], 0))
attempt('tcp', lambda: socket.create_connection(('127.0.0.1', facts['port']), 2))
attempt('vsock', lambda: socket.socket(socket.AF_VSOCK))
if facts['daemon']:  # else that is the first process of the machine
    # What the grader says goes there; to put something there would seem unread by the program.
    attempt('gate', lambda: os.open('/proc/1/fd/0', os.O_WRONLY))
attempt('unshare', lambda: ctypes.CDLL(None).unshare(0x10000000) == 0)
if facts['daemon'] and os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        os.execvp('sleep', ['sleep', '86395'])
    os._exit(0)
if facts['daemon']:
    os.wait()
print('own', 'write', open(os.path.join(os.environ['HOME'], 'f'), 'w').write('x'), flush=True)
if facts['linger']:
    signal.pause()  # the daemon would end with this program
"""


def hostile_run(box: sandbox.Sandbox, folder: Path, linger: bool) -> list[str]:
    """Run the hostile program and return what it printed."""
    hidden = Layout.here().exams / 'hidden' / 'harbour.py'
    grader = [sandbox.HERE / 'judging' / 'judge.py', hidden]
    assert all(path.exists() for path in grader)  # a missing file would count as refused
    secrets = [*map(str, (*grader, *sorted(folder.iterdir())))]
    with socket.create_server(('127.0.0.1', 0)) as server:
        facts = {
            'secrets': secrets,
            'grader': os.getpid(),
            'folder': str(folder),
            'linger': linger,
            'daemon': box.mode != 'none',  # without isolation, nothing would end it
            'port': server.getsockname()[1],
        }
        files = {'x.py': HOSTILE, 'facts.json': json.dumps(facts)}
        with box.turn(), submission_folder(files) as (submission, home):
            argv = (box.ros.python, '/grader/inside/run_node.py', '/submission/x.py')
            confined = box.start(
                Program(argv, {**INSIDE, str(submission): '/submission'}), Limits(), home
            )
            try:
                confined.release()
                lines = []
                while line := confined.process.stdout.readline():
                    lines.append(line.decode().strip())
                    if line.startswith(b'own'):
                        break
                if linger:
                    print('lingers', flush=True)
                    sys.stdin.read()
                if not lines:
                    lines = confined.process.stderr.read().decode().splitlines()
            finally:
                confined.kill()
    return lines


def held_run(box: sandbox.Sandbox) -> None:
    """Start a program without releasing it, print a line, and wait to be killed."""
    with box.turn(), submission_folder({'x.py': ''}) as (submission, home):
        argv = (box.ros.python, '/grader/inside/run_node.py', '/submission/x.py')
        program = Program(argv, {**INSIDE, str(submission): '/submission'})
        held = box.start(program, Limits(), home)
        print('up', flush=True)
        sys.stdin.read()
        held.kill()


def endless_run(box: sandbox.Sandbox) -> None:
    """Watch a program that computes forever, and print a line for each recorded event."""
    program = 'import rclpy\nrclpy.init()\nnode = rclpy.create_node("n")\n'
    program += 'import time\ntime.sleep(1)\nwhile True:\n    pass\n'
    scenario = Scenario(file='x.py', steps=(Advance(60.0),)).to_json()
    observe('endless', scenario, {'x.py': program}, box, lambda event: print('up', flush=True))


FORKS = """
import resource, time
import rclpy


def faults_of_children():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_minflt


rclpy.init()
node = rclpy.create_node('n')
before = faults_of_children()
time.sleep(20)
print(faults_of_children() - before, flush=True)
"""


def forks(box: sandbox.Sandbox) -> str:
    """Return the page faults of children that a program did not start, 0 if there are none."""
    scenario = Scenario(file='x.py', steps=(Advance(25.0),)).to_json()
    recording, _ = observe('forks', scenario, {'x.py': FORKS}, box)
    return str(recording.process['stdout']).strip()


def main() -> None:
    """Run the hostile program and two honest ones, and print the results."""
    mode, folder = sys.argv[1], Path(sys.argv[2])
    box = choose.usable(mode)
    assert box.mode == mode
    if sys.argv[3:] == ['held']:
        held_run(box)
    if sys.argv[3:] == ['run']:
        endless_run(box)
    lines = hostile_run(box, folder, sys.argv[3:] == ['linger'])
    answers = Path('tests/submissions/03_topics/pass__functions_style')
    results = []
    for name in ('talker', 'running_mean'):  # from a timer; from a callback
        exam = catalog.load(name, hidden=mode != 'none')
        files = {file: (answers / file).read_text('utf-8') for file in exam.requires}
        result = Engine(box).run(exam, files)
        results.append({**result.to_json(), 'lacks': result.max_points - result.points})
    print(json.dumps({'hostile': lines, 'results': results, 'forks': forks(box)}))


if __name__ == '__main__':
    main()
