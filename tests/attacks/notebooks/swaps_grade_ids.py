"""
Tries: hand in one answer under the grade id of another.

Stopped by: each answer has to be the file that the release says
Deserves: 20
Flag: expected the first line
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    one, other = cell(solved, 'temperature_publisher'), cell(solved, 'temperature_subscriber')
    one['metadata'], other['metadata'] = other['metadata'], one['metadata']
    return solved
