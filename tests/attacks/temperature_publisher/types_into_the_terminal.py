"""
Tries: type commands into the terminal of the user who runs the grader.

Stopped by: a separate session without a terminal
Deserves: 0
"""

import fcntl
import os
import termios

for path in ('/dev/tty', '/dev/pts/0', '/dev/pts/1', '/dev/console', '/proc/self/fd/0'):
    try:
        terminal = os.open(path, os.O_RDWR)
        for byte in b'touch /tmp/typed\n':
            fcntl.ioctl(terminal, termios.TIOCSTI, bytes([byte]))
    except OSError:
        continue
    print('ESCAPED', path)
