"""The files of the containers fit together and have the form that their tools read."""

import json
from pathlib import Path
import re

import pytest
import yaml

from deploy.container.profile import CALLS, with_namespaces

ROOT = Path(__file__).parents[2]
CONTAINER = ROOT / 'deploy' / 'container'


def test_the_profile_allows_eight_calls_more_and_forbids_no_other() -> None:
    """The profile allows eight more calls and otherwise equals that of Docker."""
    rules = [{'names': ['read'], 'action': 'SCMP_ACT_ALLOW'}]
    made = with_namespaces({'defaultAction': 'SCMP_ACT_ERRNO', 'syscalls': rules})
    assert made['defaultAction'] == 'SCMP_ACT_ERRNO'
    assert made['syscalls'][:-1] == rules
    assert set(made['syscalls'][-1]['names']) == set(CALLS)
    assert len(CALLS) == 8


@pytest.mark.parametrize('wrong', [{}, {'syscalls': []}, {'defaultAction': 'x', 'syscalls': {}}])
def test_another_file_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match='expected a seccomp profile'):
        with_namespaces(wrong)


def test_paths_and_stages_exist() -> None:
    """Compose and the development container name the Dockerfile and a stage that it has."""
    compose = yaml.safe_load((CONTAINER / 'compose.yaml').read_text())['services']['course']
    build = compose['build']
    assert (CONTAINER / build['context'] / build['dockerfile']).samefile(CONTAINER / 'Dockerfile')
    folder = ROOT / '.devcontainer'
    described = json.loads((folder / 'devcontainer.json').read_text())['build']
    assert (folder / described['dockerfile']).samefile(CONTAINER / 'Dockerfile')
    stages = re.findall(r'^FROM \S+ AS (\w+)$', (CONTAINER / 'Dockerfile').read_text(), re.M)
    assert described['target'] in stages


def test_documentation_names_the_same_calls() -> None:
    text = (ROOT / 'environment.md').read_text(encoding='utf-8')
    listed = re.search(r'adds eight system calls: ([^.]*)\.', text)
    assert listed
    assert set(re.findall(r'`(\w+)`', listed[1])) == set(CALLS)


def test_the_workflow_starts_the_image_as_compose_does() -> None:
    """The workflow tests the image with the options that a class uses."""
    compose = yaml.safe_load((CONTAINER / 'compose.yaml').read_text())['services']['course']
    workflow = yaml.safe_load((ROOT / '.github' / 'workflows' / 'image.yml').read_text())
    steps = [step.get('run', '') for step in workflow['jobs']['image']['steps']]
    start = next(step for step in steps if 'docker run' in step)
    options = [one.removesuffix(':true') for one in compose['security_opt']]
    assert re.findall(r'--security-opt (\S+)', start) == options
    assert re.findall(r'--cap-drop (\S+)', start) == compose['cap_drop']
    assert re.findall(r'--shm-size (\S+)', start) == [compose['shm_size']]
