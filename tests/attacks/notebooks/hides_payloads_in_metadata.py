"""
Tries: leave pickles, YAML objects and templates wherever a tool might load them.

Stopped by: metadata of a submission are dropped; nothing is unpickled, and YAML is only read
    from the course
Deserves: 50
"""

import base64
import os
import pickle

from tests.attacks.handing_in import PAYLOAD


class Payload:
    def __reduce__(self):
        return os.system, (f'touch {PAYLOAD}',)


def notebook(solved, blank):
    pickled = base64.b64encode(pickle.dumps(Payload())).decode()
    loaded = f'!!python/object/apply:os.system ["touch {PAYLOAD}"]'
    poison = {'pickle': pickled, 'yaml': loaded, 'jinja': '{{ 7 * 7 }}', '__class__': 'os.system'}
    solved['metadata'].update(jupytext=poison, otter=poison, widgets=poison, toc=poison)
    for one in solved['cells']:
        one['metadata'].update(poison=poison, slideshow=loaded)
        one['attachments'] = {'x.svg': {'image/svg+xml': '<svg onload="alert(1)"/>'}}
    return solved
