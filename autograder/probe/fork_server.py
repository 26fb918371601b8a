"""
Fork a probe from this process for each run, with :mod:`autograder.inside.forks`.

From this project, this file imports only ``probe/`` and ``inside/``, because the sandbox contains
no other file of the grader.
"""

import gc
import os

import probe  # type: ignore[import-not-found]  # first, because it calls use_lazy_imports()

# isort: split
import forks  # type: ignore[import-not-found]  # in inside/
from probe_wire import load_type  # type: ignore[import-not-found]

EVERY_RUN = ('rcl_interfaces/msg/Log', 'rcl_interfaces/srv/GetParameters', 'std_msgs/msg/String')


def main() -> None:
    """Load the message types that every probe needs, then fork probes on request."""
    for name in EVERY_RUN:
        load_type(name).__class__.__import_type_support__()
    gc.freeze()  # a garbage collection in a fork would copy the memory pages that it visits
    forks.serve()
    code = 1
    try:
        probe.main()
        code = 0
    except BaseException as error:  # noqa: BLE001 - skip Python's slow shutdown
        os.write(2, f'{type(error).__name__}: {error}\n'.encode(errors='replace'))
    finally:
        os._exit(code)


if __name__ == '__main__':
    main()
