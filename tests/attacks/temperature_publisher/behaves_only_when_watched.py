"""
Tries: find out whether it is being graded, and do its work only then.

Stopped by: nothing: the grader judges only what the program sends, and that is correct
Deserves: 15
"""

import os
import sys

import honest

if not os.path.exists('/grader'):
    sys.exit('nobody is looking')
honest.main()
