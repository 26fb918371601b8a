"""
Tries: hand in a web page.

Stopped by: a reason in words
Deserves: 0
Flag: not JSON
"""


def notebook(solved, blank):
    return '<!DOCTYPE html><html><script>alert(1)</script></html>'
