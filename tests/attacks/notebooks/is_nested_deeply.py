"""
Tries: break the parser with lists in lists.

Stopped by: a limit of depth, and a reason in words
Deserves: 0
Flag: nested too deeply
"""


def notebook(solved, blank):
    return '{"cells": ' + '[' * 200_000 + ']' * 200_000 + '}'
