"""
Tries: use NaN and Infinity, which are no JSON, where numbers are compared.

Stopped by: numbers of a submission are not used
Deserves: 50
"""


def notebook(solved, blank):
    solved['metadata']['points'] = [float('nan'), float('inf'), -float('inf')]
    for one in solved['cells']:
        one['execution_count'] = float('nan')
    return solved
