"""
Tries: hand in half of a file.

Stopped by: a reason in words instead of a score for the rest
Deserves: 0
Flag: ends in the middle
"""

import json


def notebook(solved, blank):
    text = json.dumps(solved)
    return text[: len(text) // 2]
