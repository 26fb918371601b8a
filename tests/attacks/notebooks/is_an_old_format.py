"""
Tries: hand in a notebook in format 3, whose cells lie elsewhere.

Stopped by: a reason in words
Deserves: 0
Flag: format 3
"""


def notebook(solved, blank):
    return {'worksheets': [{'cells': solved['cells']}], 'metadata': {}, 'nbformat': 3}
