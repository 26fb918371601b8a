"""
Tries: drown the grader in printed text.

Deserves: 0
"""

import sys

while True:
    sys.stdout.write('x' * 100000)
