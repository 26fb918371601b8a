"""For all tests: repeatable points, and programs that can be interrupted."""

import os
import signal

# Hidden inputs come from a fixed secret.
os.environ['COURSE_SECRET'] = 'the secret of the tests'

# A shell lets jobs in the background ignore interrupts, and all their programs would ignore them.
signal.signal(signal.SIGINT, signal.default_int_handler)
