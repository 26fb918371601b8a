"""
Tries: break readers of its error messages with exceptions of hostile names, texts and depth.

Stopped by: the last lines of a text are kept and escaped; only messages decide
Deserves: 0
"""

import sys

sys.setrecursionlimit(10**6)
Strange = type('\x1b[31m<script>alert(1)</script>', (BaseException,), {})


def deep(level):
    try:
        if level:
            deep(level - 1)
        else:
            raise Strange('\ud800' + '=1+1|cmd' * 1000)
    except BaseException as error:
        raise Strange('\x00\x07\r\n</pre>') from error


deep(50)
