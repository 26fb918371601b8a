"""
Tries: drown the grader in printed text.

Stopped by: 64 KB are kept; the run ends after 8 MB
Deserves: 0
Ends: output_limit
Flag: output_limit
"""

import sys

while True:
    sys.stdout.write('x' * 100000)
