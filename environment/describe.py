"""
Describe a prepared environment: the variables with which ROS 2 works in a new process.

With the wheels, everything is in the venv. With a sourced installation, the description keeps the
variables that its setup file exported, so that later shells need not source it again.
"""

from collections.abc import Iterable, Mapping
import os
from pathlib import Path

from environment.places import Places
from environment.ros import RosEnvironment

SYSTEM_PATH = ('/usr/local/sbin', '/usr/local/bin', '/usr/sbin', '/usr/bin', '/sbin', '/bin')

# Variables for every process of the course, wherever ROS comes from.
COMMON = {
    # Raise an error when a string is assigned to a number field, instead of crashing in publish().
    'ROS_PYTHON_CHECK_FIELDS': '1',
    # nbgrader gives 0 points to a grade cell with output on stderr, and JupyterLab shows it in
    # red.
    'RCUTILS_LOGGING_USE_STDOUT': '1',
    'RCUTILS_COLORIZED_OUTPUT': '1',
    'RCUTILS_CONSOLE_OUTPUT_FORMAT': '[{severity}] [{name}]: {message}',
    # Students in one room must not receive each other's messages.
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
}

# Variables that a sourced installation exports and its programs need; PYTHONPATH, PATH and
# LD_LIBRARY_PATH are handled separately.
SOURCED_NAMES = (
    'AMENT_PREFIX_PATH',
    'CMAKE_PREFIX_PATH',
    'COLCON_PREFIX_PATH',
    'CONDA_PREFIX',
    'PKG_CONFIG_PATH',
    'RMW_IMPLEMENTATION',
    'ROS_DISTRO',
    'ROS_PYTHON_VERSION',
    'ROS_VERSION',
)


def join_paths(*parts: str | Path | Iterable[str | Path]) -> str:
    """Join the parts into one search path, in order, without empty or repeated entries."""
    flat: list[str] = []
    for part in parts:
        flat += [str(part)] if isinstance(part, (str, Path)) else map(str, part)
    entries = [entry for item in flat for entry in item.split(os.pathsep) if entry]
    return os.pathsep.join(dict.fromkeys(entries))


def describe_wheels(places: Places, base_prefix: str) -> RosEnvironment:
    """Describe a venv with the ROS 2 wheels, made by the Python installed in ``base_prefix``."""
    venv, site = places.venv, places.site_packages()
    base = {
        **COMMON,
        'VIRTUAL_ENV': str(venv),
        'PATH': join_paths(venv / 'bin', SYSTEM_PATH),
        'AMENT_PREFIX_PATH': str(venv),
        # Without these two variables, every Python process would restart itself once to set them.
        # Nearly all of the hundred libraries that rclpy loads are in the first folder.
        'LD_LIBRARY_PATH': join_paths(venv / 'lib', sorted(site.glob('ros_*.libs'))),
        '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1',
        'CMAKE_TOOLCHAIN_FILE': str(places.cmake / 'ros_wheels_toolchain.cmake'),
    }
    return _describe('wheels', places, base, [str(venv), base_prefix])


def describe_sourced(
    places: Places, base_prefix: str, environ: Mapping[str, str]
) -> RosEnvironment:
    """Describe a venv with a ROS 2 installation (apt or conda) that was sourced in ``environ``."""
    kept = {name: environ[name] for name in SOURCED_NAMES if environ.get(name)}
    prefixes = environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    base = {
        **COMMON,
        **kept,
        'VIRTUAL_ENV': str(places.venv),
        'PATH': join_paths(places.venv / 'bin', [f'{p}/bin' for p in prefixes if p], SYSTEM_PATH),
    }
    for name in ('LD_LIBRARY_PATH', 'PYTHONPATH'):
        if environ.get(name):
            base[name] = join_paths(environ[name])
    return _describe(
        'sourced', places, base, [str(places.venv), base_prefix, *filter(None, prefixes)]
    )


def _describe(
    kind: str, places: Places, base: dict[str, str], folders: list[str]
) -> RosEnvironment:
    return RosEnvironment(
        kind=kind,
        python=str(places.python),
        variables=with_workspace(base, places.prefix),
        base_variables=base,
        read_only=tuple(_outermost(folders)),
        workspace=str(places.prefix),
    )


def trial_of_messages(package: str) -> str:
    """Return a Python program that imports ROS and every message of a package, if one is given."""
    if not package:
        return 'import rclpy'
    return f"""
import rclpy
import {package}.msg as messages
for name in [name for name in dir(messages) if name[0].isupper()]:
    type(getattr(messages, name)).__import_type_support__()
"""


def with_workspace(base: Mapping[str, str], prefix: Path) -> dict[str, str]:
    """Return the variables with the paths of a workspace, installed in ``prefix``, in front."""
    # Debian's CMake rules may use local/lib and dist-packages; both are accepted.
    python = [
        folder
        for pattern in ('lib/python3*/*-packages', 'local/lib/python3*/*-packages')
        for folder in sorted(prefix.glob(pattern))
    ]
    variables = {
        **base,
        'AMENT_PREFIX_PATH': join_paths(prefix, base.get('AMENT_PREFIX_PATH', '')),
        'LD_LIBRARY_PATH': join_paths(prefix / 'lib', base.get('LD_LIBRARY_PATH', '')),
        'PYTHONPATH': join_paths(python, base.get('PYTHONPATH', '')),
    }
    return {name: value for name, value in variables.items() if value}


def _outermost(folders: Iterable[str]) -> list[str]:
    """Return the existing folders, resolved, without /usr and folders inside other folders."""
    real = {str(Path(folder)) for folder in folders if Path(folder).is_dir()}
    real |= {os.path.realpath(folder) for folder in real}
    outer: list[str] = []
    for folder in sorted(real):
        inside = [*outer, '/usr']
        if not any(folder == top or folder.startswith(top + os.sep) for top in inside):
            outer.append(folder)
    return outer
