"""Tools accept the project's files for containers, Binder and GitHub's workflows."""

import json
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

pytestmark = pytest.mark.routes

ROOT = Path(__file__).parents[2]
BIN = Path(sys.prefix) / 'bin'
DEVCONTAINER = Path('node_modules', '@devcontainers', 'cli', 'devcontainer.js')
DOCKERFILE = ROOT / 'deploy' / 'container' / 'Dockerfile'
COMPOSE = ROOT / 'deploy' / 'container' / 'compose.yaml'
STUDENTS = ROOT / 'autograder' / 'authoring' / 'for_students'
WORKFLOWS = [
    path
    for folder in (ROOT, STUDENTS)
    for path in sorted((folder / '.github' / 'workflows').glob('*.yml'))
]


def run(*command: str | Path, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run a tool to its end."""
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300)


def test_hadolint_accepts_the_dockerfile(tmp_path: Path) -> None:
    """Without the file's only exception, hadolint rejects it."""
    done = run(BIN / 'hadolint', DOCKERFILE)
    assert (done.returncode, done.stdout) == (0, ''), done.stdout

    strict = tmp_path / 'Dockerfile'
    strict.write_text(DOCKERFILE.read_text().replace('# hadolint ignore=DL3008\n', ''))
    assert 'DL3008' in run(BIN / 'hadolint', strict).stdout


def test_actionlint_accepts_the_workflows(tmp_path: Path) -> None:
    """These are the project's and the students' workflows; a misspelt variable is found."""
    assert len(WORKFLOWS) == 4
    done = run(BIN / 'actionlint', *WORKFLOWS)
    assert (done.returncode, done.stdout) == (0, ''), done.stdout

    wrong = tmp_path / 'wrong.yml'
    wrong.write_text(WORKFLOWS[0].read_text().replace('matrix.python', 'matrix.pyhton', 1))
    assert 'pyhton' in run(BIN / 'actionlint', wrong).stdout


def test_the_compose_file_fits_the_schema_of_compose(tmp_path: Path) -> None:
    """The schema is a copy that check-jsonschema contains; it refuses a misspelt option."""
    check = (BIN / 'check-jsonschema', '--builtin-schema', 'vendor.compose-spec')
    done = run(*check, COMPOSE)
    assert done.returncode == 0, done.stdout

    wrong = tmp_path / 'compose.yaml'
    wrong.write_text(COMPOSE.read_text().replace('shm_size', 'shmsize'))
    assert "'shmsize' was unexpected" in run(*check, wrong).stdout


def test_repo2docker_takes_apt_post_build_and_start_of_binder() -> None:
    """repo2docker prints the Dockerfile that it would build."""
    done = run(BIN / 'jupyter-repo2docker', '--no-build', '--debug', '.')
    assert done.returncode == 0, done.stderr
    packages = (ROOT / 'binder' / 'apt.txt').read_text().splitlines()
    apt = ' '.join(line for line in packages if not line.startswith('#'))
    for taken in (f'--no-install-recommends {apt} ', 'RUN ./binder/postBuild', 'binder/start"'):
        assert taken in done.stdout + done.stderr


def test_the_command_line_of_development_containers_reads_ours(tmp_path: Path) -> None:
    """The tool reads the settings in the file, and the stage of the Dockerfile."""
    shutil.copytree(Path(__file__).parent / 'devcontainer', tmp_path, dirs_exist_ok=True)
    installed = run('npm', 'ci', '--no-audit', '--no-fund', cwd=tmp_path)
    assert installed.returncode == 0, installed.stderr

    # Replace Docker, because the tool prints nothing if Docker does not respond.
    read = ('read-configuration', '--workspace-folder', ROOT, '--docker-path', '/bin/true')
    done = run('node', tmp_path / DEVCONTAINER, *read)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)['configuration']
    described = json.loads((ROOT / '.devcontainer' / 'devcontainer.json').read_text())
    assert found.items() >= described.items()
