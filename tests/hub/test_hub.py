"""Test a class on one machine: nbgrader's buttons, and the access that students are denied."""

import os
from pathlib import Path
import subprocess
import sys

import pytest

from autograder.authoring.sample_class import compose
from autograder.layout import Layout
from deploy.hub.memory import group_of
from tests.browser.nbgrader_parts import offered
from tests.hub.running_hub import (
    ANN,
    as_user,
    BOB,
    home_of,
    Hub,
    kernels_of,
    open_cells,
    open_notebook,
    PREPARED_S,
    ROOT,
    run_cell,
    take_picture,
    TEACHER,
    wait_for_kernel,
)

pytestmark = [pytest.mark.hub, pytest.mark.timeout(3000)]

LESSON, NOTEBOOK = '07_temperature_monitor', 'temperature_monitor'
SAMPLE, WRITTEN, MARK = 'fail__two_hertz', 'explain_threshold', '4'
FAILED = 'temperature_publisher: 12 of 15 points in the visible checks'
VALIDATED_MS = 900_000
"""Maximum time in which the whole lesson runs; about a minute if nothing else runs [ms]."""

LIVE = (
    """\
from std_msgs.msg import String
from rclpy.node import Node
from roslab import *

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.1, lambda: self.publisher.publish(String(data='on')))

talker = start(Talker)
print('speaks')""",
    """\
import sys
from sensor_msgs.msg import LaserScan
listen('chatter', String).wait(5, timeout=60)
print('heard in', sys.prefix)""",
)
"""Cells of a student: the second one loads files of the environment for the first time."""


def answer(page) -> str:
    """Return the text of formgrader's dialogue, and close the dialogue."""
    dialogue = page.locator('.modal-dialog:visible')
    dialogue.wait_for()
    said = dialogue.inner_text()
    dialogue.get_by_role('button', name='OK').click()
    page.locator('.modal-backdrop').wait_for(state='detached')
    return said


def press(hub: Hub, page, kind: str) -> str:
    """Press a button of the lesson's row in formgrader, and return the text of its dialogue."""
    page.goto(f'{hub.address}user/{TEACHER}/formgrader/manage_assignments')
    page.locator(f'tr:has-text("{LESSON}")').first.locator(f'td.{kind} a').click()
    return answer(page)


def autograde(hub: Hub, page) -> str:
    """Press the button that grades the student's submission, and return formgrader's answer."""
    page.goto(f'{hub.address}user/{TEACHER}/formgrader/manage_submissions/{LESSON}')
    row = page.locator('tr', has=page.get_by_text(ANN, exact=True)).first
    row.locator('td.autograde a').click()
    said = answer(page)
    row.get_by_text('needs manual grading').wait_for()
    take_picture(page, 'formgrader', 370)
    return said


def mark(hub: Hub, page) -> None:
    """Type the points of the written answer, on the pages of the menu entry Manual Grading."""
    page.goto(f'{hub.address}user/{TEACHER}/formgrader/gradebook')
    for name in (LESSON, NOTEBOOK, 'Submission #1'):
        page.get_by_role('link', name=name).click()
    # The page saves input only after it has loaded the marks and set this class.
    points = page.locator(f'input.score.needs_manual_grade#{WRITTEN}')
    with page.expect_response(lambda response: response.request.method == 'PUT') as saved:
        points.fill(MARK)
        page.keyboard.press('Tab')
    assert saved.value.ok


def assignments(page, kind: str):
    """Open the student's list of assignments, and return the lesson's row in one of its parts."""
    page.goto(page.url.split('/lab')[0] + '/lab?reset')
    page.locator('.lm-MenuBar-itemLabel:text-is("Nbgrader")').click()
    page.locator('.lm-Menu-itemLabel:text-is("Assignment List")').click()
    return page.locator(f'#{kind}_assignments_list > .list_item', has_text=LESSON)


def read_feedback(page) -> str:
    """Fetch the feedback, open it by clicking as a student does, and return its text."""
    row = assignments(page, 'submitted')
    row.get_by_role('button', name='Fetch Feedback').click()
    row.get_by_text('view feedback').click()
    page.locator('.jp-DirListing-item', has_text=f'{NOTEBOOK}.html').dblclick()
    feedback = page.frame_locator('.jp-HTMLViewer iframe')
    checks = feedback.locator('#graded-check_temperature_publisher')
    checks.evaluate('element => element.scrollIntoView()')
    take_picture(page, 'feedback', 650)
    return feedback.locator('body').inner_text()


def validate(page) -> str:
    """Press Validate, which runs the whole open notebook, and return the text of its dialogue."""
    page.get_by_text('Validate', exact=True).click()
    dialogue = page.locator('.jp-Dialog-content')
    dialogue.get_by_text('The following cell').first.wait_for(timeout=VALIDATED_MS)
    return dialogue.inner_text()


def test_the_whole_loop(hub: Hub) -> None:
    """The test clicks its way from the lesson's source to the feedback on a student's screen."""
    teacher, ann = hub.lab_of(TEACHER), hub.lab_of(ANN)
    assert 'Success' in press(hub, teacher, 'assign')
    assert 'Success' in press(hub, teacher, 'release')

    assignments(ann, 'released').get_by_role('button', name='Fetch').click()
    ann.locator('#fetched_assignments_list > .list_item', has_text=LESSON).wait_for()
    work = home_of(ANN) / 'course' / LESSON / f'{NOTEBOOK}.ipynb'
    assert work.is_file()
    sample = ROOT / 'tests' / 'submissions' / LESSON / SAMPLE
    work.write_bytes(compose(Layout(ROOT), LESSON, sample))
    open_notebook(hub, ann, ANN, f'{LESSON}/{NOTEBOOK}.ipynb')
    assert FAILED in validate(ann)
    assignments(ann, 'fetched').get_by_role('button', name='Submit').click()
    ann.locator('#submitted_assignments_list > .list_item', has_text=LESSON).wait_for()
    ann.locator('.jp-DirListing-item', has_text=LESSON).wait_for()
    take_picture(ann, 'assignment_list', 370)

    assert 'Success' in press(hub, teacher, 'collect')
    assert 'Success' in autograde(hub, teacher)
    mark(hub, teacher)
    assert 'Success' in press(hub, teacher, 'generate-feedback')
    assert 'Success' in press(hub, teacher, 'release-feedback')
    assert f'{MARK} of 5' in read_feedback(ann)


def test_a_student_sees_only_what_is_for_students(hub: Hub) -> None:
    """Students have no formgrader, and find the ungraded lessons at once."""
    ann = hub.lab_of(ANN)
    assert offered(ann) == {'Assignment List', 'Validate'}
    assert ann.goto(hub.address + f'user/{ANN}/formgrader/').status == 404
    found = {path.name for path in (home_of(ANN) / 'course').iterdir()}
    assert {'START_HERE.ipynb', '00_quick_tour', '08_what_went_wrong'} <= found


def lab_with_kernel(hub: Hub, user: str):
    """Log a user in, and return the page when the kernel of its notebook has started."""
    page = hub.lab_of(user)
    wait_for_kernel(page)
    return page


def test_a_student_is_refused_by_the_hub(hub: Hub) -> None:
    """A student cannot reach another student's server and kernels, or the hub's interface."""
    ann, bob = lab_with_kernel(hub, ANN), lab_with_kernel(hub, BOB)
    server = f'{hub.address}user/{ANN}'
    kernel = ann.request.get(f'{server}/api/kernels').json()[0]['id']
    paths = ('/lab', '/api/contents', '/api/kernels', f'/api/kernels/{kernel}/channels')
    others = [server + path for path in paths]
    others += [f'{hub.address}hub/api/{path}' for path in ('users', f'users/{ANN}', 'proxy')]
    answers = {address: bob.request.get(address).status for address in others}
    assert set(answers.values()) <= {403, 404}, answers
    assert bob.request.post(f'{server}/api/kernels').status == 403
    assert bob.request.get(f'{hub.address}user/{BOB}/api/kernels').ok


def test_a_student_is_refused_by_the_system(hub: Hub) -> None:
    """Other users cannot read homes, hidden exams, the gradebook or the hub's secrets."""
    clone = home_of(TEACHER) / 'course'
    hidden = clone / 'exams' / 'hidden'
    assert hidden.is_dir()
    secrets = [home_of(ANN), clone, hidden, clone / 'autograder' / '_work' / 'gradebook.db']
    secrets += [hub.settings.run, hub.settings.run / 'cookie_secret']
    inbound = list(hub.settings.exchange.glob('*/inbound'))
    assert inbound, 'test_the_whole_loop releases a lesson, which creates it'
    secrets += inbound
    for place in secrets:
        assert as_user(BOB, 'ls', place).stderr.endswith('Permission denied\n'), place
    assert (
        as_user(BOB, 'find', hub.settings.copy.resolve(), '-path', '*exams/hidden*').stdout == ''
    )
    refused = as_user(BOB, 'touch', hub.settings.copy / 'notebooks' / 'mine')
    assert 'Permission denied' in refused.stderr


def test_a_wrong_password_and_an_unknown_user_stay_outside(hub: Hub) -> None:
    """A user's first password counts, and only members of the class can log in."""
    hub.lab_of(ANN)
    for user, password in ((ANN, 'a guess of somebody'), ('root', 'a guess of somebody')):
        page = hub.log_in(user, password)
        page.locator('.login_error, .alert, #login-main .error').first.wait_for()
        assert '/user/' not in page.url


def test_a_second_hub_of_the_folder_is_refused(hub: Hub) -> None:
    """A second hub would end the proxy of the first, which must keep running."""
    environ = {**os.environ, 'HUB': str(hub.settings.folder / 'hub.toml')}
    second = subprocess.run(
        [sys.executable, '-m', 'deploy.hub'], cwd=ROOT, env=environ, capture_output=True, text=True
    )
    assert second.returncode == 2
    assert f'{hub.settings.folder}: this hub is already running' in second.stderr
    hub.lab_of(ANN)


def networks_of(hub: Hub, user: str) -> dict[str, str]:
    """Return the process ids of a user's kernels, with their networks."""
    lab_with_kernel(hub, user)
    return {
        one: as_user(user, 'readlink', f'/proc/{one}/ns/net').stdout for one in kernels_of(user)
    }


def test_only_its_user_enters_the_network_of_a_kernel(hub: Hub) -> None:
    """Each kernel has a separate network, which a terminal of its user can join."""
    ann, bob = networks_of(hub, ANN), networks_of(hub, BOB)
    look = ('readlink', '/proc/self/ns/net')
    networks = [as_user(ANN, *look).stdout, *ann.values(), *bob.values()]
    assert ann
    assert bob
    assert len(set(networks)) == len(networks)

    kernel = next(iter(ann))
    join = hub.settings.copy / '.venv' / 'bin' / 'ros_world'
    assert as_user(ANN, join, kernel, typed=' '.join(look)).stdout == ann[kernel]
    enter = ('nsenter', '--preserve-credentials', '--user', '--net', '--target', kernel, 'true')
    for attempt in ((join, kernel), enter, ('cat', f'/proc/{kernel}/environ')):
        refused = as_user(BOB, *attempt)
        assert 'Permission denied' in refused.stderr, refused


def test_a_server_has_a_limit_of_memory(hub: Hub) -> None:
    """The server's processes are in the user's control group, with the limit from the settings."""
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


def test_a_kernel_keeps_running_during_an_update(hub: Hub, tmp_path: Path) -> None:
    """The kernel keeps the environment that started it; the next server gets the new one."""
    ann, bob = hub.lab_of(ANN), hub.lab_of(BOB)
    open_cells(hub, ann, ANN, *LIVE)
    run_cell(ann, 0, 'speaks')
    before = hub.settings.copy.resolve()

    newer = tmp_path / 'course'
    subprocess.run(['git', 'clone', '--quiet', '--no-hardlinks', ROOT, newer], check=True)
    with (newer / 'environment' / 'requirements.lock').open('a') as lock:
        lock.write('# newer\n')
    environ = {**os.environ, 'HUB': str(hub.settings.folder / 'hub.toml')}
    update = [sys.executable, '-m', 'deploy.hub', 'update']
    subprocess.run(update, cwd=newer, env=environ, check=True, timeout=PREPARED_S)
    after = hub.settings.copy.resolve()
    assert before != after

    run_cell(ann, 1, f'heard in {before}')
    join, ros2 = (before / '.venv' / 'bin' / name for name in ('ros_world', 'ros2'))
    typed = f'{ros2} node list'
    seen = [as_user(ANN, join, kernel, typed=typed).stdout for kernel in kernels_of(ANN)]
    assert '/talker\n' in seen
    bob.goto(f'{hub.address}hub/home')
    bob.click('#stop')
    bob.locator('#start', has_text='Start').click()
    wait_for_kernel(bob)
    servers = as_user(BOB, 'pgrep', '--euid', BOB, '--list-full').stdout
    assert f'{after}/.venv' in servers
    assert f'{before}/.venv' not in servers
