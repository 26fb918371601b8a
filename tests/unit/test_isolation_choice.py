"""Refusals name a remedy, weak modes are used only if named, and results state what is lost."""

import errno
import io
import os
from pathlib import Path
from types import SimpleNamespace

from collect_sources import laid
import pytest
from rich.console import Console

from autograder.classroom.pages import print_table, write_all_reports
from autograder.clock import virtual_clock
from autograder.commands.grade import warn_if_weak
from autograder.errors import SandboxUnavailable
from autograder.explaining.feedback import exam_text
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict
from autograder.sandboxes import choose, isolation, landlock, sandbox
from autograder.sandboxes.confinement import ConfinedProgram, Program
from autograder.sandboxes.isolation import fix_for
from environment import ros_domain
from environment.ros import RosEnvironment

UID_MAP = 'bwrap: setting up uid map: Permission denied'
LOOPBACK = 'bwrap: loopback: Failed RTM_NEWADDR: Operation not permitted'
NO_NAMESPACE = (
    'bwrap: No permissions to create new namespace, likely because the kernel does not allow '
    'non-privileged user namespaces.'
)
PIVOT = 'bwrap: pivot_root: Operation not permitted'
APPARMOR = 'proc/sys/kernel/apparmor_restrict_unprivileged_userns'
CONTAINER = '.dockerenv'


@pytest.mark.parametrize(
    ('said', 'system', 'words'),
    [
        (UID_MAP, {APPARMOR: b'1\n'}, 'apparmor_restrict_unprivileged_userns=0'),
        (LOOPBACK, {APPARMOR: b'1\n'}, '/etc/apparmor.d/bwrap'),
        (LOOPBACK, {}, '/etc/apparmor.d/bwrap'),
        (UID_MAP, {APPARMOR: b'1\n', CONTAINER: b''}, 'apparmor=unconfined'),
        (NO_NAMESPACE, {CONTAINER: b''}, '--security-opt seccomp=grader.json'),
        (NO_NAMESPACE, {CONTAINER: b''}, 'as a plain user'),
        (
            "bwrap: Can't mount proc on /newroot/proc: Operation not permitted",
            {'run/.containerenv': b''},
            'systempaths=unconfined',
        ),
        (
            NO_NAMESPACE,
            {APPARMOR: b'0\n', 'proc/sys/kernel/unprivileged_userns_clone': b'0\n'},
            'kernel.unprivileged_userns_clone=1',
        ),
        (
            NO_NAMESPACE,
            {'proc/sys/user/max_user_namespaces': b'0\n'},
            'user.max_user_namespaces=15000',
        ),
        (PIVOT, {}, '--security-opt seccomp=grader.json'),
        ('bwrap: Unknown option --disable-userns', {}, 'older than 0.8'),
        ("bwrap: Can't find source path /nowhere", {}, 'environment.md'),
    ],
)
def test_each_refusal_has_its_repair(said, system, words, tmp_path, monkeypatch):
    monkeypatch.setattr(isolation.os, 'geteuid', lambda: 1000)

    assert words in fix_for(said, laid(tmp_path, system))


@pytest.mark.parametrize(
    ('uid', 'error'), [(1000, PermissionError), (1000, ValueError), (0, None)]
)
def test_a_setting_that_cannot_be_read_or_does_not_apply_to_root_counts_as_absent(
    uid, error, tmp_path, monkeypatch
):
    def refuse(*_):
        raise error

    laid(tmp_path, {APPARMOR: b'1\n'})
    monkeypatch.setattr(isolation.os, 'geteuid', lambda: uid)
    if error:
        monkeypatch.setattr(Path, 'read_text', refuse)

    assert fix_for(NO_NAMESPACE, tmp_path) == isolation.FIX_CONTAINER


def test_a_missing_bubblewrap_is_answered_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr(choose.shutil, 'which', lambda name: None)
    with pytest.raises(SandboxUnavailable) as caught:
        choose.strongest.__wrapped__()

    assert 'sudo apt-get install -y bubblewrap' in caught.value.fix
    assert '--allow-weak=landlock' in caught.value.fix


@pytest.fixture
def clock(tmp_path, monkeypatch):
    """Return the path of a library of the virtual clock that no program can load."""
    library = tmp_path / 'clock.so'
    library.write_bytes(b'built for another system')
    monkeypatch.setattr(virtual_clock, 'clock_programs', lambda: ('driver', str(library)))
    return library


def refused(mode: str = '') -> SandboxUnavailable:
    with pytest.raises(SandboxUnavailable) as caught:
        choose.usable(mode or isolation.full(os.geteuid() == 0))
    return caught.value


@pytest.mark.parametrize('mode', ['', 'none'])
def test_a_clock_that_cannot_be_loaded_is_built_again(clock, mode):
    """The message quotes the system's loader. Without the clock, no mode runs a program."""
    assert f"object '{clock}' from LD_PRELOAD cannot be preloaded" in refused(mode).what
    assert 'make clean, then make prepare' in refused(mode).fix


def test_a_clock_on_a_file_system_without_programs_names_the_place(clock, monkeypatch):
    facts = SimpleNamespace(f_flag=os.ST_NOEXEC)
    monkeypatch.setattr(virtual_clock.os, 'statvfs', lambda path: facts)

    assert f'{clock}: the file system is mounted noexec' in refused().what
    assert 'make VENV=...' in refused().fix


@pytest.mark.parametrize(
    ('said', 'marks', 'fix'),
    [
        (UID_MAP, (), isolation.FIX_APPARMOR),
        (NO_NAMESPACE, (CONTAINER,), isolation.FIX_CONTAINER),
    ],
)
def test_a_refusal_of_the_real_start_repeats_the_words_and_adds_the_repair(
    said, marks, fix, tmp_path, monkeypatch
):
    for mark in marks:
        (tmp_path / mark).touch()
    monkeypatch.setattr(fix_for, '__defaults__', (tmp_path,))  # instead of the root folder
    program = tmp_path / 'bwrap'
    program.write_text(f'#!/bin/sh\necho "{said}" >&2\nexit 1\n', encoding='utf-8')
    program.chmod(0o755)
    monkeypatch.setattr(sandbox, 'BARE', {'PATH': f'{tmp_path}:/usr/bin:/bin'})

    assert said.rstrip('.') in refused().what
    assert refused().fix == fix


@pytest.mark.parametrize(
    ('named', 'root', 'tried'),
    [
        ('', True, ()),
        ('landlock-uid', True, ('landlock-uid',)),
        ('landlock-uid', False, ()),
        ('landlock', True, ('landlock-uid',)),
        ('landlock', False, ('landlock',)),
        ('none', True, ('landlock-uid',)),
        ('none', False, ('landlock', 'none')),
    ],
)
def test_naming_a_mode_permits_it_and_the_better_ones(named, root, tried):
    """A weak mode is used only if it is named, and root never runs programs as root."""
    assert isolation.permitted(named, root) == tried


@pytest.mark.parametrize(
    ('error', 'version', 'root', 'words'),
    [
        (errno.ENOSYS, None, True, 'no Landlock (Function not implemented)'),
        (errno.EOPNOTSUPP, None, False, 'no Landlock (Operation not supported)'),
        (0, 2, False, 'cannot protect files from a program of the same user'),
        (0, 2, True, ''),
        (0, 3, False, ''),
    ],
)
def test_a_kernel_without_landlock_says_why_and_what(error, version, root, words, monkeypatch):
    def ask() -> int:
        if error:
            raise OSError(error, '')
        return version

    monkeypatch.setattr(landlock.confine, 'landlock_version', ask)
    what, fix = landlock.refusal(root)

    assert words in what
    assert bool(what) == bool(fix) == bool(words)


def test_a_banner_says_what_is_not_protected():
    for mode in isolation.WEAK:
        text = isolation.banner(mode)
        assert mode in text
        assert all(lack in text for lack in isolation.MODES[mode].lacks)
        assert ('nothing is entered in the gradebook' in text) == (mode == 'none')


def test_a_weak_mode_runs_one_submission_at_a_time():
    console = Console(file=io.StringIO(), width=200)

    def engine(mode):
        return SimpleNamespace(sandbox=SimpleNamespace(mode=mode))

    assert warn_if_weak(engine('bwrap-root'), 4, console) == 4
    assert console.file.getvalue() == ''
    assert warn_if_weak(engine('landlock'), 4, console) == 1
    assert 'WEAK ISOLATION' in console.file.getvalue()


def test_every_place_that_shows_a_result_shows_its_weak_mode(tmp_path):
    check = CheckResult('c', 'It runs.', Verdict.PASSED, 1, 1)
    lacks = isolation.not_protected('landlock')
    exam = ExamResult('talker', (check,), mode='landlock', not_protected=lacks)
    result = SubmissionResult('s', '03_topics', (exam,))
    write_all_reports(Layout(tmp_path), '03_topics', [result])
    pages = [path.read_text(encoding='utf-8') for path in tmp_path.rglob('*.*')]
    console = Console(file=io.StringIO(), width=200)
    print_table(console, '03_topics', [result], {}, ())

    assert len(pages) == 3
    assert all('the network is shared' in page for page in pages)
    assert 'WEAK ISOLATION: landlock' in ' '.join(console.file.getvalue().split())
    assert 'weak isolation (landlock)' in exam_text(exam)
    assert SubmissionResult.from_json(result.to_json()) == result


PACKAGE = 'lib/python3.12/site-packages/temp_monitor_pkg'
CLOSED = (
    f'{PACKAGE}/temp_publisher.py',
    f'{PACKAGE}/units.pyc',
    'lib/temp_monitor_pkg/temp_publisher',
)


@pytest.fixture
def built(tmp_path):
    """Return a description of ROS whose package has readable and closed files."""
    names = (f'{PACKAGE}/__init__.py', *CLOSED, 'share/x.msg', 'lib/libx.so')
    workspace = tmp_path / 'workspace' / 'install' / 'temp_monitor_pkg'
    laid(workspace, dict.fromkeys(names, b''))
    (tmp_path / 'workspace' / 'build').mkdir()
    (tmp_path / 'bin').mkdir()
    return RosEnvironment('wheels', 'p', {}, {}, (str(tmp_path),), str(workspace))


def test_landlock_opens_everything_but_the_course_s_own_answer(built, tmp_path):
    """Files next to a closed one are opened one by one; folders above it can only be listed."""
    workspace = Path(built.workspace)
    read, names = landlock.readable(built, course_messages=True)
    assert {str(tmp_path / 'bin'), str(workspace / PACKAGE / '__init__.py')} <= set(read)
    assert {str(workspace / 'share'), str(workspace / 'lib' / 'libx.so')} <= set(read)
    for closed in CLOSED:
        assert not any(str(workspace / closed).startswith(path) for path in read)
    assert str(tmp_path) in names

    read, _ = landlock.readable(built, course_messages=False)
    assert not any(path.startswith(str(tmp_path / 'workspace')) for path in read)


def test_bubblewrap_covers_the_course_s_own_answer(built):
    workspace = Path(built.workspace)
    options = sandbox.Sandbox('bwrap-root', built)._masks(Program(['p']))

    for closed in CLOSED[:2]:
        assert options[options.index(str(workspace / closed)) - 1] == '/dev/null'
    assert str((workspace / CLOSED[2]).parent) in options
    assert str(workspace / PACKAGE / '__init__.py') not in options


def test_a_domain_in_use_is_not_taken(tmp_path, monkeypatch):
    monkeypatch.setattr(ros_domain, 'NAME', str(tmp_path))
    used = {7400 + 250 * domain + 10 for domain in range(1, 102) if domain != 42}
    monkeypatch.setattr(landlock, 'ports', lambda: used)

    claimed = landlock.claim_free_domain()
    assert claimed.domain == 42
    with pytest.raises(SandboxUnavailable, match='101 ROS domains'):
        landlock.claim_free_domain()
    claimed.holder.close()

    used.add(7400 + 250 * 42)
    with pytest.raises(SandboxUnavailable, match='101 ROS domains'):
        landlock.claim_free_domain()


def test_what_a_program_wrote_is_counted_without_a_file_system_of_its_own(tmp_path):
    """Files and bytes below the folder count, and links are not followed."""
    laid(tmp_path, {'deep/er/file': b'x' * 8192})
    (tmp_path / 'link').symlink_to('/usr')

    count, size = ConfinedProgram(None, None, 0, 0, home=tmp_path).files()

    assert count == 4
    assert size >= 8192


def test_a_folder_that_is_closed_to_others_is_named(tmp_path):
    inner = tmp_path / 'closed' / 'python'
    inner.mkdir(parents=True)
    (tmp_path / 'closed').chmod(0o700)

    found = landlock.closed_folder([str(inner)])
    assert Path(found) in (*tmp_path.parents, tmp_path / 'closed', tmp_path)
