"""A class on one machine: nbgrader's loop by its buttons, and what a student is refused."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

from autograder.authoring.sample_class import compose
from autograder.layout import Layout
from deploy.hub.memory import group_of
from tests.hub.running_hub import ANN, as_user, BOB, home_of, Hub, PAGE_MS, ROOT, TEACHER

pytestmark = [pytest.mark.hub, pytest.mark.timeout(3000)]

LESSON = '03_topics'
SAMPLE = 'fail__best_effort'
MANAGE = 'user/{}/formgrader/manage_assignments'


def press(hub: Hub, page, kind: str) -> str:
    """Press a button of the lesson's row in formgrader, and return what it says then."""
    page.goto(hub.address + MANAGE.format(TEACHER))
    row = page.locator(f'tr:has-text("{LESSON}")').first
    row.locator(f'td.{kind} a').click()
    answer = page.locator('.modal-dialog:visible')
    answer.wait_for()
    return answer.inner_text()


def assignments(page, kind: str):
    """Open the student's list of assignments, and return the lesson's row in one of its parts."""
    page.goto(page.url.split('/lab')[0] + '/lab?reset')
    page.locator('.lm-MenuBar-itemLabel:text-is("Nbgrader")').click()
    page.locator('.lm-Menu-itemLabel:text-is("Assignment List")').click()
    return page.locator(f'#{kind}_assignments_list > .list_item', has_text=LESSON)


def test_the_whole_loop(hub: Hub, tmp_path: Path) -> None:
    """From the lesson's source to the feedback on a student's screen, by clicking."""
    teacher, ann = hub.lab_of(TEACHER), hub.lab_of(ANN)
    assert 'Success' in press(hub, teacher, 'assign')
    assert 'Success' in press(hub, teacher, 'release')

    assignments(ann, 'released').get_by_role('button', name='Fetch').click()
    fetched = ann.locator('#fetched_assignments_list > .list_item', has_text=LESSON)
    fetched.wait_for()
    work = home_of(ANN) / 'course' / LESSON / 'topics.ipynb'
    assert work.is_file()
    sample = ROOT / 'tests' / 'submissions' / LESSON / SAMPLE
    work.write_bytes(compose(Layout(ROOT), LESSON, sample))
    fetched.get_by_role('button', name='Submit').click()
    ann.locator('#submitted_assignments_list > .list_item', has_text=LESSON).wait_for()

    assert 'Success' in press(hub, teacher, 'collect')
    teacher.goto(hub.address + f'user/{TEACHER}/formgrader/manage_submissions/{LESSON}')
    row = teacher.locator('tr', has=teacher.get_by_text(ANN, exact=True)).first
    row.locator('td.autograde a').click()
    answer = teacher.locator('.modal-dialog:visible')
    answer.wait_for()
    assert 'Success' in answer.inner_text(), answer.inner_text()
    teacher.screenshot(path=tmp_path / 'autograded.png')

    assert 'Success' in press(hub, teacher, 'generate-feedback')
    assert 'Success' in press(hub, teacher, 'release-feedback')
    handed_in = assignments(ann, 'submitted')
    handed_in.get_by_role('button', name='Fetch Feedback').click()
    handed_in.get_by_text('view feedback').wait_for()
    pages = list((home_of(ANN) / 'course' / LESSON / 'feedback').rglob('*.html'))
    assert pages
    ann.screenshot(path=tmp_path / 'feedback.png')
    assert 'of' in pages[0].read_text(encoding='utf-8')
    shutil.copy(pages[0], tmp_path / 'feedback.html')


def test_a_student_sees_only_what_is_for_students(hub: Hub) -> None:
    """Formgrader does not exist there, and lessons that are not graded are at hand at once."""
    ann = hub.lab_of(ANN)
    assert ann.goto(hub.address + f'user/{ANN}/formgrader/').status == 404
    found = {path.name for path in (home_of(ANN) / 'course').iterdir()}
    assert {'START_HERE.ipynb', '00_quick_tour', '08_what_went_wrong'} <= found


@pytest.mark.parametrize(
    'path',
    [
        'user/{other}/lab',
        'user/{other}/api/contents',
        'hub/api/users',
        'hub/api/users/{other}',
        'hub/api/proxy',
    ],
)
def test_a_student_is_refused_by_the_hub(hub: Hub, path: str) -> None:
    """Neither another's server nor the hub's interface answers to a student."""
    hub.lab_of(ANN)
    bob = hub.lab_of(BOB)
    answer = bob.request.get(hub.address + path.format(other=ANN))
    assert answer.status in (403, 404), answer.text()[:300]


def test_a_student_is_refused_by_the_system(hub: Hub) -> None:
    """Homes, the hidden exams, the gradebook and the hub's secrets are closed to others."""
    clone = home_of(TEACHER) / 'course'
    hidden = clone / 'autograder' / 'exams' / 'hidden'
    assert hidden.is_dir()
    secrets = [home_of(ANN), clone, hidden, hub.settings.run, hub.settings.run / 'cookie_secret']
    for place in secrets:
        assert as_user(BOB, 'ls', place).stderr.endswith('Permission denied\n'), place
    assert as_user(BOB, 'find', hub.settings.copy, '-path', '*exams/hidden*').stdout == ''
    refused = as_user(BOB, 'touch', hub.settings.copy / 'notebooks' / 'mine')
    assert 'Permission denied' in refused.stderr


def test_a_wrong_password_and_an_unknown_user_stay_outside(hub: Hub) -> None:
    """The first password counts, and only for those who are in the class."""
    hub.lab_of(ANN)
    for user, password in ((ANN, 'a guess of somebody'), ('root', 'a guess of somebody')):
        page = hub.log_in(user, password)
        page.locator('.login_error, .alert, #login-main .error').first.wait_for()
        assert '/user/' not in page.url


def test_a_second_hub_of_the_folder_is_refused(hub: Hub) -> None:
    """It would end the proxy of the first, which goes on."""
    environ = {**os.environ, 'HUB': str(hub.settings.folder / 'hub.toml')}
    second = subprocess.run(
        [sys.executable, '-m', 'deploy.hub'], cwd=ROOT, env=environ, capture_output=True, text=True
    )
    assert second.returncode == 2
    assert f'{hub.settings.folder}: this hub is already running' in second.stderr
    hub.lab_of(ANN)


def test_no_message_leaves_a_kernel(hub: Hub) -> None:
    """Each kernel has a network of its own, and a terminal of its user can join it."""
    networks = {}
    for user in (ANN, BOB):
        page = hub.lab_of(user)
        page.locator('#jp-main-statusbar', has_text='ROS 2 Jazzy | Idle').wait_for(timeout=PAGE_MS)
        pid = as_user(user, 'pgrep', '--euid', user, '--full', 'ipykernel_launcher').stdout.split()
        networks[user] = {as_user(user, 'readlink', f'/proc/{one}/ns/net').stdout for one in pid}
    own = as_user(ANN, 'readlink', '/proc/self/ns/net').stdout
    assert all(networks.values())
    assert not networks[ANN] & networks[BOB]
    assert own not in networks[ANN] | networks[BOB]


def test_a_server_has_a_limit_of_memory(hub: Hub) -> None:
    """The server's processes are in the user's control group, with the limit of the settings."""
    hub.lab_of(ANN)
    found = group_of(ANN)
    assert found, 'this system has no control group for memory'
    group, name = found
    assert int((group / name).read_text()) == hub.settings.memory_mib * 1024 * 1024
    inside = set((group / 'cgroup.procs').read_text().split())
    servers = as_user(
        ANN, 'pgrep', '--euid', ANN, '--full', 'jupyterhub-singleuser'
    ).stdout.split()
    assert servers
    assert set(servers) <= inside
