"""
Tries: name a kernel of its own, with a command to start it.

Stopped by: no kernel is started; the metadata are those of the release
Deserves: 0
"""

from tests.attacks.handing_in import PAYLOAD


def notebook(solved, blank):
    blank['metadata'] = {
        'kernelspec': {
            'name': '../../evil',
            'display_name': 'evil',
            'argv': ['touch', str(PAYLOAD)],
        },
        'language_info': {'name': 'sh', 'nbconvert_exporter': 'script', 'file_extension': '.sh'},
        'celltoolbar': 'Create Assignment',
    }
    return blank
