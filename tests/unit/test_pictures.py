"""The pictures in the documentation are screenshots that a test takes."""

import re

from tests.hub.running_hub import PICTURES, ROOT

MAX_BYTES = 150_000


def test_every_picture_shown_is_one_that_the_test_of_the_hub_takes():
    """A picture that no test takes would become outdated."""
    pages = [ROOT / 'README.md', *ROOT.glob('docs/*.md')]
    shown = {
        page.parent / name
        for page in pages
        for name in re.findall(r'!\[[^]]*\]\(([^)]+)\)', page.read_text(encoding='utf-8'))
    }
    source = (ROOT / 'tests' / 'hub' / 'test_hub.py').read_text(encoding='utf-8')
    taken = {
        PICTURES / f'{name}.png' for name in re.findall(r"take_picture\(\w+, '(\w+)', ", source)
    }
    assert shown == taken == set(PICTURES.iterdir())
    assert max(path.stat().st_size for path in taken) < MAX_BYTES
