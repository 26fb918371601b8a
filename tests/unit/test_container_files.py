"""The files of the containers fit together, and their tools can read them."""

import hashlib
import json
from pathlib import Path
import re
from typing import Any

import yaml

ROOT = Path(__file__).parents[2]
CONTAINER = ROOT / 'deploy' / 'container'
PROFILE = CONTAINER / 'grader.json'
BEFORE_A_RULE, END = ',\n\t\t{', '\n\t]\n}'
COMPOSE = yaml.safe_load((CONTAINER / 'compose.yaml').read_text())['services']['course']
DOCKERS = '536529b665dd0972c37bfb569f5d4ac8a53592e7b00752bc39ff063ca9864c74'
"""SHA-256 of Docker's profile."""


def own_rule() -> dict[str, Any]:
    return json.loads(PROFILE.read_text(encoding='utf-8'))['syscalls'][-1]


def test_profile_is_that_of_docker_and_one_more_rule() -> None:
    text = PROFILE.read_text(encoding='utf-8')
    without = f'{text[: text.rindex(BEFORE_A_RULE)]}{END}'
    assert hashlib.sha256(without.encode()).hexdigest() == DOCKERS
    assert own_rule().keys() == {'names', 'action'}
    assert own_rule()['action'] == 'SCMP_ACT_ALLOW'
    assert len(own_rule()['names']) == 8


def test_paths_and_stages_exist() -> None:
    build = COMPOSE['build']
    assert (CONTAINER / build['context'] / build['dockerfile']).samefile(CONTAINER / 'Dockerfile')
    folder = ROOT / '.devcontainer'
    described = json.loads((folder / 'devcontainer.json').read_text())['build']
    assert (folder / described['dockerfile']).samefile(CONTAINER / 'Dockerfile')
    stages = re.findall(r'^FROM \S+ AS (\w+)$', (CONTAINER / 'Dockerfile').read_text(), re.M)
    assert described['target'] in stages


def test_documentation_names_the_same_calls() -> None:
    text = (ROOT / 'environment.md').read_text(encoding='utf-8')
    listed = re.search(r'allows eight\s+system\s+calls:\s+([^.]*)\.', text)
    assert listed
    assert set(re.findall(r'`(\w+)`', listed[1])) == set(own_rule()['names'])


def test_the_workflow_starts_the_image_as_compose_does() -> None:
    workflow = yaml.safe_load((ROOT / '.github' / 'workflows' / 'image.yml').read_text())
    steps = [step.get('run', '') for step in workflow['jobs']['image']['steps']]
    start = next(step for step in steps if 'docker run' in step)
    options = [one.removesuffix(':true') for one in COMPOSE['security_opt']]
    assert re.findall(r'--security-opt (\S+)', start) == options
    assert re.findall(r'--cap-drop (\S+)', start) == COMPOSE['cap_drop']
    assert re.findall(r'--shm-size (\S+)', start) == [COMPOSE['shm_size']]
