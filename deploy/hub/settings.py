"""The settings of a hub, from its ``hub.toml``, and the folders that follow from them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
import re
import sys

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HERE = Path(__file__).resolve().parent
SETTING = 'HUB'
"""The environment variable that names another file of settings."""
LOGINS = {
    'first_use': 'firstuseauthenticator.FirstUseAuthenticator',
    'pam': 'jupyterhub.auth.PAMAuthenticator',
}
USER = re.compile(r'[a-z][a-z0-9_-]{0,30}')


class SettingsError(Exception):
    """Raised when a file of settings cannot be used; says where, and what is expected."""


@dataclass(frozen=True)
class Settings:
    """
    One hub.

    :param folder: absolute; holds everything that is installed, readable for all users
    :param port: on 127.0.0.1, 1 to 65535; its next two are for the hub and for the proxy
    :param instructor: a system user
    :param students: system users
    :param login: one of :data:`LOGINS`
    :param memory_mib: of one server with its kernels; 0 for no limit [MiB]
    :param idle_minutes: until a kernel or a server without activity is stopped [min]
    """

    folder: Path
    port: int
    instructor: str
    students: tuple[str, ...]
    login: str = 'first_use'
    memory_mib: int = 0
    idle_minutes: float = 60.0

    @property
    def users(self) -> tuple[str, ...]:
        """Everybody who may log in."""
        return (self.instructor, *self.students)

    @property
    def hub(self) -> Path:
        """The virtual environment of JupyterHub."""
        return self.folder / 'hub'

    @property
    def proxy(self) -> Path:
        """The folder of the proxy's npm packages."""
        return self.folder / 'proxy'

    @property
    def copy(self) -> Path:
        """The students' copy of the course; all students run its environment."""
        return self.folder / 'students'

    @property
    def exchange(self) -> Path:
        """The root of nbgrader's exchange."""
        return self.folder / 'exchange'

    @property
    def graded(self) -> Path:
        """The file with the names of the lessons that students fetch through nbgrader."""
        return self.folder / 'graded_lessons.txt'

    @property
    def run(self) -> Path:
        """What a running hub writes: database, secrets, passwords, log. Root's alone."""
        return self.folder / 'run'

    def course_of(self, home: Path) -> Path:
        """Return the folder of a user's own work, or of the instructor's clone."""
        return home / 'course'


def read(path: Path) -> Settings:
    """
    Read a file of settings.

    :raises SettingsError: if it is missing, is no TOML, or a value cannot be used
    """
    try:
        given = tomllib.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError) as error:
        raise SettingsError(f'{path}: {error}. Try: copy deploy/hub/hub.toml') from error
    known = {one.name for one in fields(Settings)}
    lacking = {'folder', 'port', 'instructor', 'students'} - set(given)
    if wrong := sorted(set(given) - known) or sorted(lacking):
        what = 'unknown' if set(given) - known else 'missing'
        raise SettingsError(f'{path}: {what}: {", ".join(wrong)}. It may have {sorted(known)}')
    settings = Settings(
        **{**given, 'folder': Path(given['folder']), 'students': tuple(given['students'])}
    )
    _check(path, settings)
    return settings


def _check(path: Path, settings: Settings) -> None:
    """Raise a SettingsError unless the values can be used."""
    names = [one for one in settings.users if not USER.fullmatch(one)]
    expected = {
        'folder: expected an absolute path': settings.folder.is_absolute(),
        'port: expected a number from 1024 to 65533': settings.port in range(1024, 65534),
        f'users: not a system user name: {", ".join(names)}': not names,
        'users: a name stands twice': len(set(settings.users)) == len(settings.users),
        f'login: expected one of {", ".join(LOGINS)}': settings.login in LOGINS,
        'idle_minutes: expected a number above 0': settings.idle_minutes > 0,
        'memory_mib: expected 0 or at least 512': not 0 < settings.memory_mib < 512
        and settings.memory_mib >= 0,
    }
    if wrong := [text for text, right in expected.items() if not right]:
        raise SettingsError(f'{path}: {wrong[0]}')
