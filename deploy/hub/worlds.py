"""Give each kernel a separate ROS network that no other user can enter, where possible."""

import json
from pathlib import Path
import shutil
import subprocess

from deploy.hub.settings import HERE
from environment.install_files import KERNEL_MESSAGES, KERNEL_NAME
from environment.places import write_atomically

SCRIPT, JOIN = 'own_world.sh', 'ros_world'
TRIAL_S = 20.0
FALLBACK = (
    'Kernels share the network of this machine: each uses a separate ROS domain, but a user who '
    'sets that domain on purpose can listen. Reason: {reason}'
)


def namespace_refusal(user: str) -> str:
    """
    Find out whether a user may create a network namespace.

    :param user: the system account that tries it
    :returns: empty if it works, otherwise the reason in one line
    """
    script = (HERE / SCRIPT).read_text(encoding='utf-8')  # the user may not be able to read it
    command = ['runuser', '-u', user, '--', 'sh', '-c', script, 'sh', 'true']
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TRIAL_S, cwd='/')
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    lines = done.stderr.strip().splitlines()
    return '' if done.returncode == 0 else (lines or [f'code {done.returncode}'])[-1]


def install(venv: Path, *, separate: bool) -> None:
    """
    Make an environment start each kernel in a separate network namespace, or undo this.

    The server reaches such a kernel over Unix sockets, because no network address leads into the
    namespace.

    :param venv: a prepared environment of the course
    :param separate: whether this system allows it, which may have changed since the last start
    """
    for source, name in ((SCRIPT, SCRIPT), ('join_world.sh', JOIN)):
        shutil.copyfile(HERE / source, venv / 'bin' / name)
        (venv / 'bin' / name).chmod(0o755)
    script = str(venv / 'bin' / SCRIPT)
    kernel = venv / 'share' / 'jupyter' / 'kernels' / KERNEL_NAME / 'kernel.json'
    spec = json.loads(kernel.read_text(encoding='utf-8'))
    command = [word for word in spec['argv'] if word != script]
    spec['argv'] = [script, *command] if separate else command
    write_atomically(kernel, json.dumps(spec, indent=1) + '\n')
    config = venv / 'etc' / 'jupyter' / 'jupyter_server_config.json'
    settings = json.loads(config.read_text(encoding='utf-8'))
    settings['KernelManager'] = {'transport': 'ipc'} if separate else KERNEL_MESSAGES
    write_atomically(config, json.dumps(settings, indent=1) + '\n')
