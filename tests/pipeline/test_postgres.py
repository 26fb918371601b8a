"""Run the same test cases on a temporary PostgreSQL server: ``make test-postgres``."""

from glob import glob
import os
from pathlib import Path
import shutil
import subprocess
import tempfile
import uuid

import gradebooks
import pytest

pytestmark = [pytest.mark.postgres, pytest.mark.nbgrader]

INSTALL = 'sudo apt-get install -y postgresql'
USER, PORT = 'grader', '54321'


def program(name: str) -> str:
    """Return the path of a server program, which Debian keeps outside the PATH."""
    found = shutil.which(name) or next(iter(sorted(glob(f'/usr/lib/postgresql/*/bin/{name}'))), '')
    assert found, f'PostgreSQL is not installed. Try: {INSTALL}'
    return found


def as_server(*command: str) -> None:
    """Run a server program as the server's user, because it refuses root."""
    owner = {'user': 'postgres', 'group': 'postgres'} if os.geteuid() == 0 else {}
    done = subprocess.run(
        command, cwd='/', capture_output=True, text=True, timeout=240, check=False, **owner
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope='module')
def server():
    """Yield the socket folder of a new server that does not listen on the network."""
    with tempfile.TemporaryDirectory(prefix='pg_') as folder:  # the path of a socket must be short
        if os.geteuid() == 0:
            shutil.chown(folder, 'postgres', 'postgres')
        data = str(Path(folder, 'data'))
        as_server(program('initdb'), '-D', data, '-U', USER, '-A', 'trust', '-E', 'UTF8', '-N')
        options = f'-k {folder} -p {PORT} -c listen_addresses= -c fsync=off'
        log = str(Path(folder, 'log'))
        as_server(program('pg_ctl'), '-D', data, '-l', log, '-o', options, '-w', 'start')
        try:
            yield folder
        finally:
            as_server(program('pg_ctl'), '-D', data, '-m', 'fast', '-w', 'stop')


@pytest.fixture
def in_postgres(course, server):
    """Return a course whose gradebook is a new database of the server."""
    name = f'gradebook_{uuid.uuid4().hex[:8]}'
    as_server(program('createdb'), '-h', server, '-p', PORT, '-U', USER, name)
    config = course.root / 'nbgrader_config.py'
    url = f'postgresql+psycopg://{USER}@/{name}?host={server}&port={PORT}'
    text = config.read_text(encoding='utf-8') + f'\nc.CourseDirectory.db_url = {url!r}\n'
    config.write_text(text, encoding='utf-8')
    (course.work / 'gradebook.db').unlink()
    return course


@pytest.mark.parametrize('scene', gradebooks.ALL, ids=lambda scene: scene.__name__)
def test_postgres(scene, in_postgres):
    """All cases pass as on SQLite, and no gradebook file is written."""
    gradebooks.begin(in_postgres)

    scene(in_postgres)

    assert not (in_postgres.work / 'gradebook.db').exists()
