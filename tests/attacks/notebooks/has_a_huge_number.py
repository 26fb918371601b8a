"""
Tries: let the parser compute for hours on a number of a million digits.

Stopped by: no number of a submission is computed
Deserves: 50
"""

import json


def notebook(solved, blank):
    return json.dumps(solved)[:-1] + ', "number": ' + '9' * 3_000_000 + '}'
