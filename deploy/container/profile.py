"""
Extend Docker's seccomp profile with the system calls that the grader's sandbox needs.

    python3 deploy/container/profile.py default.json > deploy/container/grader.json

``default.json`` is Docker's default profile, published by the project moby/profiles.
"""

from __future__ import annotations

import json
from pathlib import Path
import sys
from typing import Any

CALLS = (
    *('clone', 'unshare', 'setns', 'sethostname'),  # namespaces
    *('mount', 'umount', 'umount2', 'pivot_root'),  # to mount file systems in them
)


def with_namespaces(profile: dict[str, Any]) -> dict[str, Any]:
    """
    Return a seccomp profile that also allows :data:`CALLS`.

    :param profile: a profile in Docker's format
    :raises ValueError: if the profile has an unexpected format
    """
    if not isinstance(profile.get('syscalls'), list) or 'defaultAction' not in profile:
        raise ValueError('expected a seccomp profile with defaultAction and syscalls')
    rule = {'names': sorted(CALLS), 'action': 'SCMP_ACT_ALLOW'}
    return {**profile, 'syscalls': [*profile['syscalls'], rule]}


if __name__ == '__main__':
    try:
        given = json.loads(Path(sys.argv[1]).read_text(encoding='utf-8'))
        print(json.dumps(with_namespaces(given), indent=1))
    except (IndexError, OSError, ValueError) as error:
        sys.exit(f'profile.py: {error}. Try: python3 profile.py default.json > grader.json')
