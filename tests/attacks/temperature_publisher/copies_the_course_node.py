"""
Tries: hand in the course's own publisher, which is installed with the messages.

Stopped by: empty mounts hide the course's own nodes; only the messages are importable
Deserves: 0
"""

import glob
import runpy
import sys

try:
    from temp_monitor_pkg.temp_publisher import main
except ImportError:
    found = glob.glob(f'{sys.prefix}/workspace/**/temp_publisher*', recursive=True)
    found += glob.glob('/**/temp_monitor_pkg/temp_publisher*', recursive=True)
    for path in found:
        try:
            runpy.run_path(path, run_name='__main__')
        except Exception:
            continue
else:
    main()
