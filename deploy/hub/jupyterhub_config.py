"""
Configure JupyterHub for the course; ``jupyterhub`` reads this file when ``deploy.hub`` starts it.

Students use the environment of the shared students' copy; the instructor uses that of a clone.
"""

import os
from pathlib import Path
import pwd
import shutil
import subprocess
import sys

from jupyterhub.spawner import LocalProcessSpawner

from deploy.hub.memory import limit
from deploy.hub.settings import LOGINS, read, SETTING

c = get_config()  # defined by JupyterHub

settings = read(Path(os.environ[SETTING]))
idle_s = int(60 * settings.idle_minutes)
look_s = min(60, idle_s // 4)
"""Time between a server's activity reports, and between checks for idle kernels or servers [s]."""


class CourseSpawner(LocalProcessSpawner):
    """Starts a user's server in the folder of the course, with a memory limit."""

    async def start(self) -> tuple[str, int]:
        """Start the server and apply the limit before the server can start a kernel."""
        started = await super().start()
        if settings.memory_mib and not limit(self.user.name, self.pid, settings.memory_mib):
            self.log.warning('No memory limit: this system offers no control group for it.')
        return started


def prepare_server(spawner: CourseSpawner) -> None:
    """Choose the environment and the folder of a server, and copy the lessons for a student."""
    name = spawner.user.name
    home = Path(pwd.getpwnam(name).pw_dir)
    course = settings.course_of(home)
    mine = name == settings.instructor
    # Resolve the link now: an update may change its target while this server runs.
    venv = (course if mine else settings.copy.resolve()) / '.venv'
    spawner.environment = {
        'COURSE_EXCHANGE': str(settings.exchange),
        'JUPYTERHUB_ACTIVITY_INTERVAL': str(look_s),
        'LANG': 'C.UTF-8',
        'PATH': f'{venv}/bin:/usr/local/bin:/usr/bin:/bin',
    }
    if not mine:
        _copy_lessons(name, course)
    # nbgrader reads its settings from the folder in which the server starts.
    spawner.cmd = ['sh', '-c', f'cd {course} && exec {venv}/bin/jupyterhub-singleuser "$@"', 'sh']
    spawner.notebook_dir = str(course)
    spawner.default_url = '/lab/tree/' + ('notebooks/' if mine else '') + 'START_HERE.ipynb'


def _copy_lessons(name: str, course: Path) -> None:
    """Copy the lessons not fetched through nbgrader, as the student and without overwriting."""
    source, graded = settings.copy / 'notebooks', settings.graded.read_text(encoding='utf-8')
    wanted = [path for path in sorted(source.iterdir()) if path.name not in graded.split()]
    copy = 'mkdir -p "$0" && cp -r --no-clobber "$@" "$0/"'
    command = ['runuser', '-u', name, '--', 'sh', '-c', copy, str(course), *map(str, wanted)]
    subprocess.run(command, check=True, cwd='/')


c.JupyterHub.bind_url = f'http://127.0.0.1:{settings.port}/'
c.JupyterHub.hub_port = settings.port + 1
c.JupyterHub.spawner_class = CourseSpawner
c.JupyterHub.db_url = f'sqlite:///{settings.run}/hub.sqlite'
c.JupyterHub.cookie_secret_file = str(settings.run / 'cookie_secret')
c.JupyterHub.pid_file = str(settings.run / 'hub.pid')
c.JupyterHub.template_vars = {'announcement_login': 'ROS 2 nodes and topics'}
c.ConfigurableHTTPProxy.command = [
    shutil.which('node') or 'node',
    f'{settings.proxy}/node_modules/configurable-http-proxy/bin/configurable-http-proxy',
]
c.ConfigurableHTTPProxy.api_url = f'http://127.0.0.1:{settings.port + 2}'
c.ConfigurableHTTPProxy.pid_file = str(settings.run / 'proxy.pid')

c.JupyterHub.authenticator_class = LOGINS[settings.login]
c.Authenticator.allowed_users = set(settings.users)
c.PAMAuthenticator.open_sessions = False
c.FirstUseAuthenticator.dbm_path = str(settings.run / 'passwords.dbm')
c.FirstUseAuthenticator.create_users = False

c.Spawner.pre_spawn_hook = prepare_server
c.Spawner.start_timeout = 120
c.Spawner.http_timeout = 120  # 30 s, the default, is too short for ten starts at once
c.Spawner.args = [
    '--MultiKernelManager.default_kernel_name=ros2_jazzy',
    # jupyter_server_config.py defines what counts as activity.
    f'--MappingKernelManager.cull_idle_timeout={idle_s}',
    f'--MappingKernelManager.cull_interval={look_s}',
    '--MappingKernelManager.cull_connected=True',
]

# The proxy would count every response as activity, and an open page keeps sending requests.
c.JupyterHub.last_activity_interval = 0
c.JupyterHub.load_roles = [
    {
        'name': 'culler',
        'scopes': ['list:users', 'read:users:activity', 'read:servers', 'delete:servers'],
        'services': ['culler'],
    }
]
c.JupyterHub.services = [
    {
        'name': 'culler',
        'command': [
            *(sys.executable, '-m', 'jupyterhub_idle_culler'),
            # The hub may learn of a user's last activity up to two intervals late.
            *(f'--timeout={idle_s + 2 * look_s}', f'--cull-every={look_s}'),
        ],
    }
]
