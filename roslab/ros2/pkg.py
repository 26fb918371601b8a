"""Implement ``ros2 pkg`` and ``ros2 run``; a new package builds and runs without changes."""

import argparse
import getpass
import os
from pathlib import Path
import re
import shlex
import shutil
import subprocess
import sys

from ament_index_python.packages import (
    get_package_prefix,
    get_packages_with_prefixes,
    PackageNotFoundError,
)

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.pkg_files import ament_cmake_files, ament_python_files, NewPackage

_LICENSES = (
    'Apache-2.0',
    'BSL-1.0',
    'BSD-2.0',
    'BSD-2-Clause',
    'BSD-3-Clause',
    'GPL-3.0-only',
    'LGPL-3.0-only',
    'MIT',
    'MIT-0',
)
_FILES = {'ament_cmake': ament_cmake_files, 'ament_python': ament_python_files}
_LICENSE_FILE = Path(__file__).with_name('LICENSE')
"""The course's own license, Apache-2.0, is the only one whose text is included."""


class PackageMissingError(RuntimeError):
    """Raised if no installed package has the given name."""

    def __init__(self) -> None:
        super().__init__('Package not found')


_PACKAGE = option('package_name', help='Name of the ROS package')


def prefix_of(package: str) -> Path:
    """Return the folder of an installed package; PackageMissingError if it is not installed."""
    try:
        return Path(get_package_prefix(package))
    except (PackageNotFoundError, ValueError):
        raise PackageMissingError from None


def executables_of(package: str) -> list[Path]:
    """Return the programs of a package that ``ros2 run`` can start, sorted."""
    folder = prefix_of(package) / 'lib' / package
    return sorted(
        path for path in folder.rglob('*') if path.is_file() and os.access(path, os.X_OK)
    )


@verb(
    'pkg executables',
    option('package_name', nargs='?', help='Name of the ROS package'),
    flag('--full-path', 'print full paths'),
)
def executables(args: argparse.Namespace) -> None:
    """Output a list of package specific executables."""
    names = [args.package_name] if args.package_name else sorted(get_packages_with_prefixes())
    for name in names:
        for path in executables_of(name):
            print(path if args.full_path else f'{name} {path.name}')


@verb('pkg list')
def list_packages(_: argparse.Namespace) -> None:
    """Output a list of available packages."""
    print('\n'.join(sorted(get_packages_with_prefixes())))


@verb('pkg prefix', _PACKAGE, flag('--share', 'print its folder for shared files'))
def prefix(args: argparse.Namespace) -> None:
    """Output the prefix path of a package."""
    path = prefix_of(args.package_name)
    print(path / 'share' / args.package_name if args.share else path)


def executable_of(package: str, name: str) -> Path | None:
    """Return a program of a package, else None; RuntimeError if the package is not installed."""
    try:
        found = executables_of(package)
    except PackageMissingError:
        raise RuntimeError(f"Package '{package}' not found") from None
    return next((path for path in found if path.name == name), None)


@verb(
    'run',
    option('--prefix', help="command to put in front, such as 'gdb -ex run --args'"),
    _PACKAGE,
    option('executable_name', help='Name of the executable'),
    option('argv', nargs=argparse.REMAINDER, help='arguments of the executable, --ros-args ...'),
)
def run(args: argparse.Namespace) -> None:
    """Replace this process with the executable, which then gets Ctrl-C and sets the exit code."""
    path = executable_of(args.package_name, args.executable_name)
    if path is None:
        raise RuntimeError('No executable found')
    command = [*shlex.split(args.prefix or ''), str(path), *args.argv]
    try:
        os.execvp(command[0], command)
    except OSError as error:
        raise RuntimeError(f'{command[0]}: {error.strerror}') from None


@verb(
    'pkg create',
    option('package_name', help='The package name'),
    option('--package-format', type=int, default=3, choices=[2, 3]),
    option('--description', default='TODO: Package description'),
    option('--license', default='TODO: License declaration', help="'?' lists the known names"),
    option('--destination-directory', default='.', help='where to create its folder'),
    option('--build-type', default='ament_cmake', choices=list(_FILES)),
    option('--dependencies', nargs='+', default=[], help='list of dependencies'),
    option('--maintainer-email', help='email address of the maintainer'),
    option('--maintainer-name', help='name of the maintainer'),
    option('--node-name', help='name of the empty executable'),
)
def create(args: argparse.Namespace) -> None:
    """Create a new ROS 2 package."""
    if args.license == '?':
        print('Supported licenses:', *_LICENSES, sep='\n')
        return
    _refuse(args)
    package = _package(args)
    destination = Path(args.destination_directory)
    _announce(package, destination)
    _write(package, destination)
    if package.license == 'Apache-2.0' and _LICENSE_FILE.is_file():
        shutil.copyfile(_LICENSE_FILE, destination / package.name / 'LICENSE')
    elif package.license not in _LICENSES:
        print(
            f"\n[WARNING]: Unknown license '{package.license}'.  This has been set in the "
            'package.xml, but no LICENSE file has been created.\n'
            'It is recommended to use one of the ament license identifiers:\n'
            + '\n'.join(_LICENSES)
        )


def _refuse(args: argparse.Namespace) -> None:
    """Raise a RuntimeError if the package cannot be created."""
    for what, name in (('package', args.package_name), ('node', args.node_name or 'x')):
        if not re.fullmatch(r'[a-z][a-z0-9_]*', name):
            raise RuntimeError(
                f"Aborted since '{name}' is not a valid {what} name: expected a lower case "
                'letter, then lower case letters, digits and underscores.'
            )
    if args.build_type == 'ament_python' and args.package_name == 'test':
        raise RuntimeError(
            "Aborted since 'ament_python' packages can't be named 'test', the name of the folder "
            'for their tests.'
        )
    path = f'{args.destination_directory.rstrip("/")}/{args.package_name}'
    if Path(path).exists():
        raise RuntimeError(
            f'\nAborted!\nThe directory already exists: {path}\nEither remove the directory or '
            'choose a different destination directory or package name'
        )


def _package(args: argparse.Namespace) -> NewPackage:
    maintainer = args.maintainer_name or getpass.getuser()
    return NewPackage(
        name=args.package_name,
        format=args.package_format,
        description=args.description,
        license=args.license,
        maintainer=maintainer,
        email=args.maintainer_email or _git_email() or f'{maintainer}@todo.todo',
        build_type=args.build_type,
        dependencies=tuple(args.dependencies),
        node=args.node_name or '',
    )


def _git_email() -> str:
    git = shutil.which('git')
    if git is None:
        return ''
    done = subprocess.run([git, 'config', 'user.email'], capture_output=True, text=True)
    return done.stdout.strip()


def _announce(package: NewPackage, destination: Path) -> None:
    facts = {
        'package name': package.name,
        'destination directory': destination.resolve(),
        'package format': package.format,
        'version': '0.0.0',
        'description': package.description,
        'maintainer': [f'{package.maintainer} <{package.email}>'],
        'licenses': [package.license],
        'build type': package.build_type,
        'dependencies': list(package.dependencies),
    }
    if package.node:
        facts['node_name'] = package.node
    print('going to create a new package')
    for name, value in facts.items():
        print(f'{name}: {value}')


def _write(package: NewPackage, destination: Path) -> None:
    """Write the files, and print the same lines as the real command."""
    root = f'{str(destination).rstrip("/")}/{package.name}'
    folders: set[str] = set()
    for name, text in _FILES[package.build_type](package).items():
        path = f'{root}/{name}'
        folder = path.rpartition('/')[0]
        if folder not in folders:
            folders.add(folder)
            print('creating folder', folder)
            Path(folder).mkdir(parents=True, exist_ok=True)
        if path.endswith('/'):
            continue  # an empty folder needs no contents
        print('creating', path)
        try:
            Path(path).write_text(text, encoding='utf-8')
        except OSError as error:
            print(f'{path}: {error.strerror}', file=sys.stderr)
            raise RuntimeError(f'unable to create {path}') from None
