"""Read the settings of a hub from its ``hub.toml``, and derive its folders from them."""

from dataclasses import dataclass, fields
from pathlib import Path
import re

from autograder.layout import read_toml
from environment.places import Below

HERE = Path(__file__).resolve().parent
SETTING = 'HUB'
"""The environment variable that names a different settings file."""
LOGINS = {
    'first_use': 'firstuseauthenticator.FirstUseAuthenticator',
    'pam': 'jupyterhub.auth.PAMAuthenticator',
}
USER = re.compile(r'[a-z][a-z0-9_-]{0,30}')


class SettingsError(Exception):
    """Raised for an unusable settings file; the message gives the place and a valid value."""


@dataclass(frozen=True)
class Settings:
    """
    The settings of one hub.

    :param folder: absolute path of the whole installation, readable by all users
    :param port: on 127.0.0.1, 1024 to 65533; the next two ports are for the hub and the proxy
    :param instructor: system account of the instructor
    :param students: system accounts of the students
    :param login: how users log in, one of :data:`LOGINS`
    :param memory_mib: memory limit of one server with its kernels, 0 for no limit [MiB]
    :param idle_minutes: time after which an idle kernel or server is stopped, at least 0.5 [min]
    """

    folder: Path
    port: int
    instructor: str
    students: tuple[str, ...]
    login: str = 'first_use'
    memory_mib: int = 0
    idle_minutes: float = 60.0

    hub = Below('folder', 'hub')
    """The virtual environment of JupyterHub."""
    proxy = Below('folder', 'proxy')
    """The folder of the proxy's npm packages."""
    copy = Below('folder', 'students')
    """A link to the students' copy of the course, whose environment all students use."""
    exchange = Below('folder', 'exchange')
    """The root folder of nbgrader's exchange."""
    graded = Below('folder', 'graded_lessons.txt')
    """The file with the names of the lessons that students fetch through nbgrader."""
    run = Below('folder', 'run')
    """Files of the running hub: database, secrets, passwords, log. Only root can read them."""

    @property
    def users(self) -> tuple[str, ...]:
        """All accounts that may log in."""
        return (self.instructor, *self.students)

    def course_of(self, home: Path) -> Path:
        """Return the folder of a student's work, or the instructor's clone."""
        return home / 'course'


def read(path: Path) -> Settings:
    """
    Read a settings file.

    :raises SettingsError: if the file is missing or is not TOML, or a value is invalid
    """
    try:
        given = read_toml(path)
    except (OSError, ValueError) as error:
        raise SettingsError(f'{path}: {error}. Try: copy deploy/hub/hub.toml') from error
    known = {one.name for one in fields(Settings)}
    lacking = {'folder', 'port', 'instructor', 'students'} - set(given)
    if wrong := sorted(set(given) - known) or sorted(lacking):
        what = 'unknown' if set(given) - known else 'missing'
        raise SettingsError(f'{path}: {what}: {", ".join(wrong)}. Known: {sorted(known)}')
    settings = Settings(
        **{**given, 'folder': Path(given['folder']), 'students': tuple(given['students'])}
    )
    _check(path, settings)
    return settings


def _check(path: Path, settings: Settings) -> None:
    """Raise a SettingsError if a value is invalid."""
    names = [one for one in settings.users if not USER.fullmatch(one)]
    expected = {
        'folder: expected an absolute path': settings.folder.is_absolute(),
        'port: expected a number from 1024 to 65533': settings.port in range(1024, 65534),
        f'users: not a system user name: {", ".join(names)}': not names,
        'users: a name is listed twice': len(set(settings.users)) == len(settings.users),
        f'login: expected one of {", ".join(LOGINS)}': settings.login in LOGINS,
        'idle_minutes: expected at least 0.5': settings.idle_minutes >= 0.5,
        'memory_mib: expected 0 or at least 512': not 0 < settings.memory_mib < 512
        and settings.memory_mib >= 0,
    }
    if wrong := [text for text, right in expected.items() if not right]:
        raise SettingsError(f'{path}: {wrong[0]}')
