"""
Tries: hand in more than can be read.

Stopped by: files above 16 MiB are not read
Deserves: 0
Flag: a file of at most 16 MiB
"""


def notebook(solved, blank):
    solved['metadata']['padding'] = 'x' * (17 << 20)
    return solved
