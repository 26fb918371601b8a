"""
Replace Python in a message build: let a warm process run the program, and end as it ended.

The set-up copies this file below a first line that names the interpreter, and CMake uses the copy
as Python.  It must start quickly, so it imports almost nothing.  Python itself runs every program
that is not in :data:`PROGRAMS`.
"""

import _socket as socket  # what socket imports would double the time
from array import array
import os
import sys

SOCKET = 'ROS2_COURSE_WARM_PYTHON'
"""Environment variable with the path at which the warm process listens."""
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
"""Names of files, and of modules that are started with ``-m``."""


def main() -> None:
    """Send the program to the warm process, or become the Python that was requested."""
    words = sys.argv[1:]
    named = words[1:2] if words[:1] == ['-m'] else words[:1]
    if named and os.path.basename(named[0]) in PROGRAMS and SOCKET in os.environ:
        handed_over(words)
    os.execv(sys.executable, [sys.executable, *words])


def handed_over(words: list[str]) -> None:
    """
    Send a command line with its environment, and end with the exit code that comes back.

    The function returns if no warm process is listening.
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
