"""Message packages of environment/messages.txt: valid lines, and installed packages."""

from dataclasses import replace
import os
from pathlib import Path
import re
import subprocess
import sys
import sysconfig
from unittest.mock import Mock

from collect_sources import laid, packed
import pytest

from environment import interpreters, messages, stamps
from environment import plan as plan_module
from environment.doctor import check_messages, MISSING, OK
from environment.places import MESSAGES_FILE, Places
from environment.plan import Plan
from environment.ros import further_messages
from environment.steps import Job, StepError

pytestmark = pytest.mark.slow  # pip installs toy packages


def test_comments_and_empty_lines_name_nothing():
    """The project's own file has only comments and names no package."""
    assert messages.wanted(MESSAGES_FILE.read_text(encoding='utf-8')) == {}
    assert messages.wanted('\nRos-Toy_Msgs==1.0  # for lesson 20\n') == {'ros-toy-msgs': '1.0'}


@pytest.mark.parametrize(
    ('line', 'advice'),
    [
        ('toy_msgs', 'ros-toy-msgs==VERSION; to list its versions: '),
        ('ros-toy-msgs', 'ros-toy-msgs==VERSION; to list its versions: '),
        ('ros-toy-msgs>=1.0', 'ros-toy-msgs==VERSION; to list its versions: '),
        ('ros-jazzy-toy-msgs==1.0', 'ros-toy-msgs==1.0'),
        ('toy-msgs==1.0', 'ros-toy-msgs==1.0'),
    ],
)
def test_refused_line_is_named_with_the_line_to_write(line, advice):
    """Metapackages do not work without their dependencies, and a range is not reproducible."""
    with pytest.raises(StepError) as caught:
        messages.wanted(f'# first\n{line}\n')

    assert str(caught.value) == (
        f'environment/messages.txt, line 2: expected ros-NAME==VERSION, got {line}'
    )
    assert caught.value.try_this.startswith(advice)


def report(*requires: str) -> dict[str, object]:
    """Return pip's report on one package with these requirements."""
    metadata = {'name': 'ros-toy-msgs', 'version': '1.0', 'requires_dist': list(requires)}
    return {'install': [{'metadata': metadata}]}


def test_requirements_names_the_packages_that_are_used():
    """Extras are never installed."""
    asked = report('ros-std-msgs~=5.3.6', 'ros-a-msgs', 'x; extra == "test"')

    found = messages.requirements(asked, {'ros-std-msgs': '5.3.7', 'ros-a-msgs': '1'})

    assert found == {'ros-toy-msgs': {'ros-std-msgs', 'ros-a-msgs'}}


@pytest.mark.parametrize(
    ('asked', 'said', 'advice'),
    [
        ('ros-b-msgs~=2.1', 'ros-toy-msgs uses ros-b-msgs, which is not', 'add the line ros-b-ms'),
        ('ros-std-msgs~=5.5.1', 'requires ros-std-msgs~=5.5.1; the installed', 'for Jazzy'),
        ('ros-std-msgs~=5.3.8', 'requires ros-std-msgs~=5.3.8; the installed', 'for Jazzy'),
        ('ros-std-msgs==5.3.7', 'requires ros-std-msgs==5.3.7; the installed', 'for Jazzy'),
    ],
)
def test_package_of_another_distribution_is_refused(asked, said, advice):
    """The compiled code of a different distribution would be incompatible."""
    with pytest.raises(StepError) as caught:
        messages.requirements(report(asked), {'ros-std-msgs': '5.3.6'})

    assert str(caught.value).startswith('environment/messages.txt: ros-toy-msgs')
    assert said in str(caught.value)
    assert advice in caught.value.try_this


class SetUp:
    """
    Run the step in a small virtual environment, with wheels from a folder.

    :param folder: folder for the environment, the wheels and messages.txt
    """

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Create the environment, which uses the pip of this Python."""
        self.file, self.wheels = folder / 'messages.txt', folder / 'wheels'
        self.wheels.mkdir()
        monkeypatch.setattr(stamps, 'MESSAGES_FILE', self.file)
        monkeypatch.setattr(plan_module.stamps, 'packages_digest', lambda *_: 'same')
        self.places = Places.of('.venv', folder)
        make = [sys.executable, '-m', 'venv', '--without-pip', str(self.places.venv)]
        subprocess.run(make, check=True)
        self.places.notes.mkdir()
        with_pip = sysconfig.get_path('purelib')
        (self.places.site_packages() / 'pip.pth').write_text(with_pip, encoding='utf-8')
        alone = {'PIP_NO_INDEX': '1', 'PIP_FIND_LINKS': str(self.wheels)}
        alone |= {'PIP_CONFIG_FILE': os.devnull}
        python = interpreters.probe(sys.executable, os.environ)
        self.plan = Plan(self.places, {**os.environ, **alone}, 'wheels', python)

    def wheel(self, name: str, *requires: str) -> None:
        whole = name.replace('-', '_')
        info = f'{whole}-1.0.dist-info'
        metadata = ['Metadata-Version: 2.1', f'Name: {name}', 'Version: 1.0']
        metadata += [f'Requires-Dist: {one}' for one in requires]
        files = {
            f'{whole.removeprefix("ros_")}/__init__.py': b'',
            f'{info}/METADATA': '\n'.join(metadata).encode(),
            f'{info}/WHEEL': b'Wheel-Version: 1.0\nTag: py3-none-any\n',
            f'{info}/RECORD': b'',
        }
        packed(self.wheels / f'{whole}-1.0-py3-none-any.whl', files)

    def go(self, text: str) -> None:
        self.file.write_text(text, encoding='utf-8')
        with (self.places.notes / 'messages.log').open('w', encoding='utf-8') as log:
            messages.install_messages(self.plan, Job(log))

    @property
    def modules(self) -> set[str]:
        return {path.name for path in self.places.site_packages().glob('*_msgs')}


@pytest.fixture
def set_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SetUp:
    """Return a set-up with the wheels of two packages, one of which uses the other."""
    made = SetUp(tmp_path, monkeypatch)
    made.wheel('ros-toy-msgs', 'ros-base-msgs~=1.0')
    made.wheel('ros-base-msgs')
    return made


def test_named_packages_are_installed_and_others_removed(set_up):
    set_up.go('ros-toy-msgs==1.0\nros-base-msgs==1.0\n')

    assert set_up.modules == {'toy_msgs', 'base_msgs'}
    assert further_messages(set_up.places.venv) == {
        'toy_msgs': ['ros-base-msgs==1.0', 'ros-toy-msgs==1.0'],
        'base_msgs': ['ros-base-msgs==1.0'],
    }
    set_up.go('ros-base-msgs==1.0\n')

    assert set_up.modules == {'base_msgs'}
    assert further_messages(set_up.places.venv).keys() == {'base_msgs'}


def test_refused_file_installs_nothing(set_up):
    set_up.go('ros-base-msgs==1.0\n')

    for line, said in {
        'ros-none-msgs==1.0': 'environment/messages.txt: pip cannot install ros-none-msgs==1.0',
        'ros-toy-msgs==1.0': 'ros-toy-msgs uses ros-base-msgs, which is not installed',
        'ros-std-msgs==5.3.6': 'ros-std-msgs==5.3.6 is always installed',
    }.items():
        with pytest.raises(StepError, match=re.escape(said)):
            set_up.go(f'{line}\n')

        assert set_up.modules == {'base_msgs'}


def test_stopped_installation_is_noted_and_removed_by_the_next(set_up, monkeypatch):
    """Without a note, an installed wheel would remain in the environment unnoticed."""
    monkeypatch.setattr(messages, '_closure', Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        set_up.go('ros-base-msgs==1.0\n')
    set_up.go('')

    assert set_up.modules == set()
    assert further_messages(set_up.places.venv) == {}


def test_editing_the_file_needs_only_its_own_step(set_up):
    """The virtual environment and the course's ROS package are not prepared again."""
    steps = ('venv', 'packages', 'workspace', 'messages')
    set_up.file.write_text('', encoding='utf-8')
    before = {step: set_up.plan.digest(step) for step in steps}

    set_up.file.write_text('ros-toy-msgs==1.0\n', encoding='utf-8')

    changed = [step for step in steps if set_up.plan.digest(step) != before[step]]
    assert changed == ['messages']


def test_sourced_installation_has_to_have_the_packages(set_up, tmp_path):
    """The versions are those of the installation, and nothing is installed from PyPI."""
    laid(tmp_path, {'ros/share/toy_msgs/package.xml': b'<version>2.3.4</version>'})
    environ = {'AMENT_PREFIX_PATH': f'/nowhere:{tmp_path / "ros"}'}
    set_up.plan = replace(set_up.plan, kind='sourced', environ=environ)

    set_up.go('ros-toy-msgs==1.0\n')

    assert further_messages(set_up.places.venv) == {'toy_msgs': ['ros-toy-msgs==2.3.4']}
    with pytest.raises(StepError, match=r'messages\.txt: the sourced ROS 2 has no package my_ms'):
        set_up.go('ros-my-msgs==1.0\n')


def test_doctor_names_the_file_and_what_is_missing(set_up):
    """Without a network, the note in the environment is enough."""
    set_up.go('ros-base-msgs==1.0\n')

    assert check_messages(set_up.places).state == OK

    set_up.file.write_text('ros-base-msgs==1.0\nros-my-msgs==1.0\n', encoding='utf-8')
    finding = check_messages(set_up.places)
    assert finding.state == MISSING
    assert finding.detail == 'environment/messages.txt names my_msgs, which is not installed'

    set_up.file.write_text('my_msgs\n', encoding='utf-8')
    assert 'environment/messages.txt, line 1: ' in check_messages(set_up.places).detail
    assert check_messages(set_up.places).fix.startswith('ros-my-msgs==VERSION')


def test_missing_file_names_nothing(set_up):
    """A copy of the course may not have the file."""
    set_up.go('')
    set_up.file.unlink()

    messages.install_messages(set_up.plan, Job(sys.stderr))

    assert check_messages(set_up.places).state == OK


@pytest.mark.parametrize('text', ['', '[]', '{'])
def test_damaged_note_means_no_further_packages(tmp_path, text):
    """The next set-up writes the note again."""
    (tmp_path / 'ros_messages.json').write_text(text, encoding='utf-8')

    assert further_messages(tmp_path) == {}
