"""
Tries: fill the memory with a small file of countless empty lists.

Stopped by: parts are counted before anything is made of them
Deserves: 0
Flag: far too many parts
"""


def notebook(solved, blank):
    return '{"cells": [' + '[],' * 2_000_000 + '[]]}'
