"""
Tries: hand in check cells that already have outputs, with full points in them.

Stopped by: outputs of a submission are never read
Deserves: 0
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    for one in checks(blank):
        data = {'text/plain': '15.0', 'text/html': '<script>alert(1)</script>'}
        one['outputs'] = [
            {'output_type': 'execute_result', 'data': data, 'metadata': {}, 'execution_count': 1},
            {'output_type': 'stream', 'name': 'stdout', 'text': 'all checks passed'},
        ]
        one['execution_count'] = 1
    return blank
