"""
Tries: put numbers, lists and nothing where texts and objects belong.

Stopped by: parts of a wrong type count as empty
Deserves: 0
Flag: expected cells of this assignment
"""


def notebook(solved, blank):
    for number, one in enumerate(blank['cells']):
        one['source'] = (None, 7, [1, None, {}], {'a': 1})[number % 4]
        one['metadata'] = (None, [], 'text', 3)[number % 4]
    blank['cells'] += [None, 3, [], 'text', {'cell_type': ['code']}]
    return blank
