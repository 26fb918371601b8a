"""Make points repeatable, programs interruptible and garbage collection quick, for all tests."""

import gc
import os
import signal

# Hidden inputs come from a fixed secret.
os.environ['COURSE_SECRET'] = 'the secret of the tests'

# A shell starts background jobs with SIGINT ignored, and their child processes inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Let the garbage collector skip what has been collected, which lasts as long as the tests."""
    gc.collect()
    gc.freeze()
