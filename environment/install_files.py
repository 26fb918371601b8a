"""Write the files that adapt a venv to the course: .pth, kernel, description, settings."""

import json
from pathlib import Path
import shlex
import shutil

from environment.places import Places, PROJECT, write_atomically
from environment.ros import FILE_NAME, RosEnvironment
from environment.ros2_command import discovery_variables, installed_ros2

KERNEL_NAME = 'ros2_jazzy'
KERNEL_TITLE = 'ROS 2 Jazzy'
KERNEL_MESSAGES = {'transport_encryption': 'auto'}
"""Settings for the messages between the server and its kernels."""
EXTENSION = 'roslab.error_hints'
"""IPython extension that every kernel loads; if it is missing, a kernel starts anyway."""
INSTRUCTORS_PANELS = ('course-list', 'create-assignment', 'formgrader')
INSTRUCTORS_SERVERS = ('course_list', 'formgrader')
"""Parts of nbgrader that students do not need, by their names in JupyterLab and its server."""
AUTOSAVE_S = 10
"""Seconds between two automatic saves; JupyterLab's default is two minutes."""
STYLE = """\
/* Written by the set-up. JupyterLab breaks lines of output in the middle of words. */
body .jp-OutputArea-output pre { word-break: normal; overflow-wrap: anywhere; }
/* JupyterLab's yellow and red are too pale or too dark: mix them with the colour of the text. */
body .jp-OutputArea-output { --mix: in srgb, var(--jp-content-font-color1); }
body .jp-OutputArea-output pre .ansi-yellow-fg { color: color-mix(var(--mix), #ddb62b); }
body .jp-OutputArea-output pre :is(.ansi-red-fg, .ansi-red-intense-fg) {
  color: color-mix(var(--mix), #e75c58);
}
/* JupyterLab holds only the active cell in place while it draws others; a link selects a cell. */
body .jp-Notebook .jp-Cell.jp-mod-selected { overflow-anchor: auto; }
"""
ROS2_MARK = "the course's own small ros2 command"


def kernel_spec(ros: RosEnvironment) -> dict[str, object]:
    """Return the contents of kernel.json, which sets the ROS environment."""
    # Jupyter expands ${PATH}, so the learner's own programs are found after those of the venv.
    path = {'PATH': f'{Path(ros.python).parent}:${{PATH}}'}
    variables = {**discovery_variables(ros), **ros.variables, **path}
    launch = [ros.python, '-m', 'ipykernel_launcher', '-f', '{connection_file}']
    return {
        'argv': [*launch, f'--ext={EXTENSION}'],
        'display_name': KERNEL_TITLE,
        'language': 'python',
        'metadata': {'debugger': True, 'supported_encryption': ['curve']},
        'env': variables,
    }


def write_kernel(places: Places, ros: RosEnvironment) -> None:
    """Install the Jupyter kernel of the course in the venv."""
    folder = places.venv / 'share' / 'jupyter' / 'kernels' / KERNEL_NAME
    write_atomically(folder / 'kernel.json', json.dumps(kernel_spec(ros), indent=1) + '\n')
    stock = folder.with_name('python3')
    for logo in stock.glob('logo-*'):
        shutil.copyfile(logo, folder / logo.name)


def write_jupyter_settings(places: Places) -> None:
    """
    Adapt JupyterLab to the course.

    JupyterLab's question about news is switched off: it uses the network and distracts learners.
    Messages between the server and its kernels are encrypted: other users of the machine cannot
    read them, and no kernel warns about plain messages in the learner's terminal.  Terminals start
    with the course's PATH.  Students' copies omit the parts of nbgrader that instructors use.
    Unless the user chooses otherwise, notebooks are saved every few seconds: ``check`` compares
    the saved notebook with the file that it judges, to notice a cell that was edited but not run.
    """
    panels = [f'@jupyter/nbgrader:{name}' for name in INSTRUCTORS_PANELS]
    disabled = ['@jupyterlab/apputils-extension:announcements']
    disabled += panels if places.for_students else []
    shell = [str(places.terminal / 'shell')]
    servers = {
        f'nbgrader.server_extensions.{name}': not places.for_students
        for name in INSTRUCTORS_SERVERS
    }
    page = places.venv / 'etc' / 'jupyter' / 'labconfig' / 'page_config.json'
    try:
        page_settings = json.loads(page.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        page_settings = {}
    page_settings.setdefault('disabledExtensions', {}).update(dict.fromkeys(disabled, True))
    for name, settings in {
        'etc/jupyter/jupyter_server_config.json': {
            'KernelManager': KERNEL_MESSAGES,
            'ServerApp': {
                'terminado_settings': {'shell_command': shell},
                'jpserver_extensions': servers,
            },
        },
        'etc/jupyter/labconfig/page_config.json': page_settings,
        'etc/jupyter/jupyter_lab_config.json': {'LabApp': {'custom_css': True}},
        'share/jupyter/lab/settings/overrides.json': {
            '@jupyterlab/docmanager-extension:plugin': {
                'autosaveInterval': AUTOSAVE_S,
                # On a busy machine, a save that overtakes the previous one looks like a change by
                # another program, and JupyterLab asks whether to overwrite it.
                'lastModifiedCheckMargin': 1000 * AUTOSAVE_S,
            },
            # Feedback and tracebacks name lines of a cell.
            '@jupyterlab/notebook-extension:tracker': {'codeCellConfig': {'lineNumbers': True}},
        },
    }.items():
        write_atomically(places.venv / name, json.dumps(settings, indent=1) + '\n')
    # Apart from the user's own settings, the server looks for the style only here.
    style = places.site_packages() / 'jupyter_server' / 'static' / 'custom' / 'custom.css'
    write_atomically(style, STYLE)


def write_terminal(places: Places) -> None:
    """
    Write the program that a JupyterLab terminal starts: the user's shell with the course's PATH.

    JupyterLab's default is a login shell, which sets PATH as if there were no virtual environment.
    """
    own, venv = shlex.quote(str(places.terminal)), shlex.quote(str(places.venv / 'bin'))
    make = shlex.quote(shutil.which('make') or 'make')
    texts = {
        'shell': (
            # `make lab` may have started the server and set these; its ARGS must not apply here.
            'unset ARGS MAKEFLAGS MAKELEVEL MAKEOVERRIDES MFLAGS\n'
            f'PATH={own}/bin:{venv}:$PATH\nexport PATH\n'
            'case "${SHELL##*/}" in\n'
            f'  "" | sh | dash | bash) exec bash --rcfile {own}/bashrc ;;\n'
            'esac\nexec "$SHELL"\n'
        ),
        'bashrc': f'[ -r ~/.bashrc ] && . ~/.bashrc\nPATH={own}/bin:{venv}:$PATH\n',
        'bin/make': (
            "# Without a Makefile here or an option that names one, use the course's Makefile.\n"
            'case " $* " in *" -"[Cf]* | *" --directory"* | *" --file"* | *" --makefile"*) ;;\n'
            '  *) [ -e GNUmakefile ] || [ -e makefile ] || [ -e Makefile ] ||\n'
            f'    set -- --no-print-directory -C {shlex.quote(str(places.project))} "$@" ;;\n'
            f'esac\nexec {make} "$@"\n'
        ),
    }
    for name, text in texts.items():
        path = places.terminal / name
        write_atomically(path, f'#!/bin/sh\n# Written by the set-up.\n{text}')
        path.chmod(0o755)


def write_ros2_command(places: Places, ros: RosEnvironment) -> None:
    """Install the course's ``ros2`` only if the ROS installation has none."""
    script = places.venv / 'bin' / 'ros2'
    if installed_ros2(ros) is None:
        # Without site and Python's environment variables, the command starts quickly.
        program = PROJECT / 'environment' / 'ros2_command.py'
        command = shlex.join(map(str, (places.python, '-S', '-E', program, places.venv)))
        _write_script(script, f': {ROS2_MARK}', command)
    elif script.is_file() and ROS2_MARK in script.read_text(errors='replace'):
        script.unlink()


def write_autograder_command(places: Places) -> None:
    """Install ``autograder``, which is ``python -m autograder``; students' copies lack it."""
    if (PROJECT / 'autograder' / '__main__.py').is_file():
        # Python would search the current folder first, which may contain students' files.
        code = (
            'import sys; sys.path = list(filter(None, sys.path)); '
            'from autograder.__main__ import main; sys.exit(main())'
        )
        command = shlex.join((str(places.python), '-c', code))
        _write_script(places.venv / 'bin' / 'autograder', '', command)


def _write_script(path: Path, about: str, command: str) -> None:
    text = f'#!/bin/sh\n# Written by the set-up{about}.\nexec {command} "$@"\n'
    write_atomically(path, text)
    path.chmod(0o755)


def write_description(places: Places, ros: RosEnvironment) -> None:
    """Write the description that :func:`environment.ros.ros_environment` reads."""
    write_atomically(places.venv / FILE_NAME, ros.to_json())


def install_files(places: Places, ros: RosEnvironment) -> None:
    """Write the path file, kernel, commands, Jupyter settings and description."""
    # Put the grader and the course on the venv's module path.
    lines = ''.join(f'{folder}\n' for folder in dict.fromkeys((places.project, PROJECT)))
    write_atomically(places.site_packages() / 'ros2_course.pth', lines)
    write_kernel(places, ros)
    write_ros2_command(places, ros)
    write_autograder_command(places)
    write_jupyter_settings(places)
    write_terminal(places)
    write_description(places, ros)
