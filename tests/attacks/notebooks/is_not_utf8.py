"""
Tries: hand in another encoding.

Stopped by: a reason in words
Deserves: 0
Flag: not UTF-8
"""

import json


def notebook(solved, blank):
    return json.dumps(solved, ensure_ascii=False).encode('utf-16')
