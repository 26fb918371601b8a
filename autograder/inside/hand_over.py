"""
Replace Python in a message build: run programs in a process that has loaded their imports.

The set-up copies this file below a first line that names the interpreter, and CMake uses the copy
as its Python.  The file must start quickly, so it imports almost nothing.  It passes the programs
in :data:`PROGRAMS` to ``warm_python.py``; Python itself runs all others.
"""

import _socket as socket  # the imports of socket would double the start-up time
from array import array
import os
import sys

SOCKET = 'ROS2_COURSE_WARM_PYTHON'
"""Environment variable with the path of the socket of ``warm_python.py``."""
PROGRAMS = frozenset(
    {
        'compileall',
        'package_xml_2_cmake.py',
        'rosidl_adapter',
        'rosidl_generator_c',
        'rosidl_generator_py',
        'rosidl_generator_type_description',
        'rosidl_typesupport_c',
        'rosidl_typesupport_fastrtps_c',
        'rosidl_typesupport_introspection_c',
        'setup.py',
        'templates_2_cmake.py',
    }
)
"""Programs for ``warm_python.py``: names of files, and of modules started with ``-m``."""


def main() -> None:
    """Send a program of :data:`PROGRAMS` to ``warm_python.py``; run any other in this process."""
    words = sys.argv[1:]
    named = words[1:2] if words[:1] == ['-m'] else words[:1]
    if named and os.path.basename(named[0]) in PROGRAMS and SOCKET in os.environ:
        handed_over(words)
    os.execv(sys.executable, [sys.executable, *words])


def handed_over(words: list[str]) -> None:
    """
    Send a command line with its environment, and exit with the exit code in the reply.

    The function returns only if no process is listening.
    """
    environment = [f'{name}={value}' for name, value in os.environ.items()]
    fields = [str(len(words)), *words, os.getcwd(), *environment]
    standard = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array('i', (0, 1, 2)))]
    server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        server.connect(os.environ[SOCKET])
        server.sendmsg([os.fsencode('\0'.join(fields))], standard)
    except OSError:
        return
    answer = server.recv(1)
    os._exit(answer[0] if answer else 1)


if __name__ == '__main__':
    main()
