"""nbgrader's exchange on a machine that students share: students hand in as themselves."""

from collections.abc import Iterator
import os
from pathlib import Path
import pwd
import shutil
import stat
import subprocess
import sys
import tempfile

from conftest import ASSIGNMENT
from nbgrader.apps.api import NbGraderAPI
import pytest

from autograder.collect.copy_notebooks import collect
from autograder.collect.deliveries import LEFT, TAKEN
from autograder.gradebook.database import load_config
from autograder.layout import Layout
from autograder.submission.inbox import SECRET
from environment.exchange import SETTING

pytestmark = pytest.mark.nbgrader

NOTEBOOK = 'temperature_monitor.ipynb'
COURSE_ID = 'ros2_nodes_and_topics'
LATER = '2999-01-01 12:00:00.000000 UTC'
ME = pwd.getpwuid(os.geteuid()).pw_name
ANN, BOB = [one for one in pwd.getpwall() if one.pw_uid][:2]
"""Two users of this system, neither of them root."""

needs_root = pytest.mark.skipif(os.geteuid() != 0, reason='only root can act as two users')

# Import everything first, because a user may not be able to read this project.
AS_USER = """
import os, sys
from nbgrader.apps.submitapp import SubmitApp
user, group, home, code = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], sys.argv[4]
os.setgroups([])
os.setgid(group)
os.setuid(user)
os.chdir(home)
exec(code)
"""
SUBMIT = f"SubmitApp.launch_instance(['{ASSIGNMENT}'])"


@pytest.fixture
def exchange(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return an exchange that every user of the machine can reach."""
    with tempfile.TemporaryDirectory(prefix='exchange-') as folder:
        Path(folder).chmod(0o777)
        monkeypatch.setenv(SETTING, folder)
        yield Path(folder)


@pytest.fixture
def nbgrader(course: Layout, exchange: Path) -> NbGraderAPI:
    """Return the API that formgrader's buttons call, for a course with a released assignment."""
    config = load_config(course)
    api = NbGraderAPI(config=config)
    assert api.release_assignment(ASSIGNMENT)['success']
    return api


def act(user: pwd.struct_passwd, home: Path, code: str) -> str:
    """Run code as a different user of the system; return its output."""
    ids = str(user.pw_uid), str(user.pw_gid)
    done = subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', AS_USER, *ids, str(home), code],
        env={'HOME': str(home), 'PATH': os.environ['PATH']},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def homes(exchange: Path) -> Iterator[dict[str, Path]]:
    """Return the home folders of two students, each with a notebook."""
    with tempfile.TemporaryDirectory(prefix='homes-') as folder:
        Path(folder).chmod(0o755)
        found = {}
        for user in (ANN, BOB):
            home = found[user.pw_name] = Path(folder) / user.pw_name
            (home / ASSIGNMENT).mkdir(parents=True)
            (home / ASSIGNMENT / NOTEBOOK).write_text(f'of {user.pw_name}', encoding='utf-8')
            (home / 'nbgrader_config.py').write_text(
                'c = get_config()\n'
                f'c.Exchange.root = {str(exchange)!r}\n'
                f'c.CourseDirectory.course_id = {COURSE_ID!r}\n',
                encoding='utf-8',
            )
            for path in (home, *home.rglob('*')):
                shutil.chown(path, user.pw_uid, user.pw_gid)
        yield found


def collected(course: Layout) -> dict[str, str]:
    """Return the notebooks in ``submitted/``, by student."""
    return {
        path.parts[-3]: path.read_text(encoding='utf-8')
        for path in course.submitted.rglob(NOTEBOOK)
    }


def lay(exchange: Path, student: str, text: str = 'mine') -> Path:
    """Write a delivery to the exchange by hand."""
    folder = exchange / COURSE_ID / 'inbound' / f'{student}+{ASSIGNMENT}+{LATER}+x'
    folder.mkdir()
    (folder / NOTEBOOK).write_text(text, encoding='utf-8')
    (folder / 'timestamp.txt').write_text(LATER, encoding='utf-8')
    return folder


def test_release_protects_the_exchange(nbgrader, exchange):
    """Only the owner of a delivery and the instructor can move it."""
    inbound = exchange / COURSE_ID / 'inbound'

    assert stat.S_IMODE(exchange.stat().st_mode) == 0o1777
    assert stat.S_IMODE(inbound.stat().st_mode) == 0o3733


@needs_root
def test_work_that_bob_hands_in_as_ann_is_refused(nbgrader, exchange, homes, course):
    """Although Bob's delivery looks newer, both collectors keep Ann's own work."""
    ann, bob = ANN.pw_name, BOB.pw_name
    act(ANN, homes[ann], SUBMIT)
    (hers,) = (exchange / COURSE_ID / 'inbound').glob(f'{ann}+*')
    forged = hers.with_name(f'{ann}+{ASSIGNMENT}+{LATER}')
    act(BOB, homes[bob], f"{SUBMIT}\nimport shutil\nshutil.copytree('{ASSIGNMENT}', '{forged}')")

    rows = collect(exchange, course, course.work / 'ours', ASSIGNMENT)
    answer = nbgrader.collect(ASSIGNMENT)

    assert {(row.student, row.done) for row in rows} == {(ann, TAKEN), (ann, LEFT), (bob, TAKEN)}
    said = f"handed in as '{ann}', but owned by '{bob}'"
    assert [row.notes[0].partition(';')[0] for row in rows if row.done == LEFT] == [said]
    ours = course.work / 'ours' / ann / ASSIGNMENT / NOTEBOOK
    assert ours.read_text(encoding='utf-8') == f'of {ann}'
    assert answer['success']
    assert said in answer['log']
    assert collected(course) == {ann: f'of {ann}', bob: f'of {bob}'}


@needs_root
def test_bob_can_neither_move_nor_exchange_what_ann_handed_in(nbgrader, exchange, homes, course):
    """Bob may even know the name of her folder, which no other student can list."""
    ann, bob = ANN.pw_name, BOB.pw_name
    act(ANN, homes[ann], SUBMIT)
    (hers,) = (exchange / COURSE_ID / 'inbound').glob(f'{ann}+*')
    said = act(
        BOB,
        homes[bob],
        'import shutil\n'
        f'for do in (os.listdir, lambda path: os.rename(path, path + "x")):\n'
        f'    try:\n        do({str(hers.parent)!r} if do is os.listdir else {str(hers)!r})\n'
        "    except PermissionError:\n        print('refused')\n"
        f"os.unlink('{hers}/{NOTEBOOK}')\n"
        f"shutil.copy('{ASSIGNMENT}/{NOTEBOOK}', '{hers}/{NOTEBOOK}')\n",
    )

    rows = collect(exchange, course, course.submitted, ASSIGNMENT)
    answer = nbgrader.collect(ASSIGNMENT)

    assert said.split() == ['refused', 'refused']
    assert [(row.student, row.done) for row in rows] == [(ann, LEFT)]
    assert f"handed in as '{ann}', but owned by '{bob}'" in answer['log']
    assert collected(course) == {}


def test_formgrader_refuses_what_the_instructor_laid_until_the_owner_is_recorded(
    nbgrader, exchange, course
):
    """On a laptop all deliveries belong to one user."""
    lay(exchange, 'ann')

    refused = nbgrader.collect(ASSIGNMENT)
    assert f"handed in as 'ann', but owned by '{ME}'" in refused['log']
    assert collected(course) == {}

    with (course.root / 'nbgrader_config.py').open('a', encoding='utf-8') as file:
        file.write(f"c.ExchangeCollect.owners = {{'ann': {ME!r}}}\n")
    answer = nbgrader.collect(ASSIGNMENT)

    assert 'cheating' not in answer['log']
    assert collected(course) == {'ann': 'mine'}
    assert stat.S_IMODE((course.submitted / 'ann' / ASSIGNMENT).stat().st_mode) == 0o755


def test_formgrader_trusts_names_when_nbgraders_own_setting_says_so(nbgrader, exchange, course):
    """The setting is called ``check_owner``."""
    lay(exchange, 'ann')
    nbgrader.config.ExchangeCollect.check_owner = False

    nbgrader.collect(ASSIGNMENT)

    assert collected(course) == {'ann': 'mine'}


def test_formgrader_follows_no_link_to_the_solutions(nbgrader, exchange, course):
    """The copy is made with the rights of the instructor, who may read everything."""
    folder = lay(exchange, ME)
    (folder / NOTEBOOK).unlink()
    (folder / NOTEBOOK).symlink_to(course.solutions / ASSIGNMENT / NOTEBOOK)

    answer = nbgrader.collect(ASSIGNMENT)

    assert f'{NOTEBOOK}: not taken; a link or a special file' in answer['log']
    assert collected(course) == {}


def test_formgrader_collects_the_others_if_a_delivery_is_too_large(nbgrader, exchange, course):
    """A recorded bag among the files does not end the collection, and an update loses nothing."""
    folder = lay(exchange, ME)
    nbgrader.collect(ASSIGNMENT)
    with (folder / 'run.mcap').open('wb') as file:
        file.truncate(1 << 30)
    (folder / NOTEBOOK).write_text('mine, again', encoding='utf-8')

    (folder / SECRET).write_text('of the second delivery', encoding='utf-8')

    answer = nbgrader.collect(ASSIGNMENT)

    assert answer['success']
    assert collected(course) == {ME: 'mine, again'}
    secret = course.submitted / ME / ASSIGNMENT / SECRET
    assert secret.read_text(encoding='utf-8') == 'of the second delivery'


def test_collect_refuses_options_that_it_does_not_have(nbgrader, exchange, course):
    lay(exchange, ME)
    nbgrader.config.ExchangeCollect.before_duedate = True

    answer = nbgrader.collect(ASSIGNMENT)

    assert not answer['success']
    assert 'Leave out --student and --before-duedate' in answer['log'] + answer['error']
    assert collected(course) == {}
