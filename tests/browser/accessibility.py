"""What axe finds on a page: https://github.com/dequelabs/axe-core."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def violations(page: Any, *ignored: str, of: str = 'html') -> list[tuple[str, str]]:
    """
    Return the rules that a page breaks, each with its first element.

    :param page: of a context with ``bypass_csp``, because axe is a script
    :param ignored: rules that do not count
    :param of: selector of the elements that count
    """
    import axe_playwright_python

    page.evaluate((Path(axe_playwright_python.__file__).parent / 'axe.min.js').read_text('utf-8'))
    found = page.evaluate('of => axe.run(of)', of)['violations']
    return [
        (one['id'], one['nodes'][0]['html'][:300]) for one in found if one['id'] not in ignored
    ]
