"""Choose the program that a scenario runs, its files and its limits."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
import shutil
import tempfile
from typing import Any

from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.forked import INSIDE
from autograder.sandboxes.sandbox import HERE
from environment.ros import RosEnvironment

CHECK_FILES = {
    str(HERE / name): f'/grader/{name}' for name in ('probe/probe_wire.py', 'simulated.py')
}
"""Grader files that the sandbox shows to a check written by a student."""
BUILDS = ('build', 'package')
"""Values of ``program`` in a scenario for which colcon builds a package first."""
# Building messages takes about 5 s of processor time, up to six times as much on slow machines.
BUILD_LIMITS = Limits(cpu_s=30)
# A package run builds the package and then runs its program, so the two limits add up.
PACKAGE_LIMITS = Limits(cpu_s=BUILD_LIMITS.cpu_s + Limits.cpu_s)


def program_for(
    scenario: Mapping[str, Any], submission: Path, ros: RosEnvironment
) -> tuple[Program, Limits]:
    """
    Return the program that a scenario runs, and its limits.

    :param submission: host folder with the student's files, readable by every user
    """
    python = ros.python
    binds = {**INSIDE, str(submission): '/submission'}
    if scenario['program'] == 'build':
        argv = [python, '/grader/inside/build_package.py', '/submission']
        argv += [scenario['build_type'].partition('/')[0], scenario['build_type']]
        return Program(argv, binds, course_messages=False), BUILD_LIMITS
    if scenario['program'] == 'package':
        argv = [python, '/grader/inside/run_package.py', '/submission', scenario['build_type']]
        argv += [scenario['file'].removesuffix('.py'), *_ros_arguments(scenario)]
        # A package with the name of the course's message package builds the messages itself.
        own = scenario['build_type'] == ros.package
        return Program(argv, binds, course_messages=not own), PACKAGE_LIMITS
    argv = [python, '/grader/inside/run_node.py']
    if scenario['program'] == 'check':
        binds |= CHECK_FILES
        argv += ['/grader/inside/ask_check.py', *CHECK_FILES.values()]
    argv += [f'/submission/{scenario["file"]}']
    return Program([*argv, *_ros_arguments(scenario)], binds), Limits()


def _ros_arguments(scenario: Mapping[str, Any]) -> list[str]:
    follows = ['-p', 'use_sim_time:=true'] if scenario['ros_clock'] else []
    given = [*follows, *scenario['arguments']]
    return ['--ros-args', *given] if given else []


@contextmanager
def submission_folder(files: Mapping[str, str]) -> Iterator[tuple[Path, Path]]:
    """
    Yield a temporary folder with the student's files, and an empty home folder.

    :param files: text by relative path; the grader's parser has validated the paths
    """
    base = Path(tempfile.mkdtemp(prefix='run-'))
    try:
        base.chmod(0o755)
        submission, home = base / 'submission', base / 'home'
        for folder in (submission, home):
            folder.mkdir(mode=0o755)
        for name, text in files.items():
            path = submission / name
            path.parent.mkdir(mode=0o755, parents=True, exist_ok=True)
            path.write_text(text, encoding='utf-8', errors='replace')
            path.chmod(0o644)
        yield submission, home
    finally:
        shutil.rmtree(base, ignore_errors=True)
