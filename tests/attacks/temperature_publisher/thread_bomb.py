"""
Tries: use up the threads of the machine.

Stopped by: a limit of 64 processes and threads for each sandbox
Deserves: 0
"""

import threading
import time

made = 0
while True:
    try:
        threading.Thread(target=time.sleep, args=(100,), daemon=True).start()
        made += 1
    except RuntimeError:
        break
if made > 64:
    print('ESCAPED', made)
