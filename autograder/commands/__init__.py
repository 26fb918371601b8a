"""One module per command, and the exit codes of all commands."""

OK = 0
"""Everything has a verdict."""
FOR_REVIEW = 1
"""Some submissions are for review."""
USAGE = 2
"""The command cannot be done: its arguments, or our own fault."""
STOPPED = 130
"""Ctrl-C: 128 and the number of SIGINT."""
UNREAD = 141
"""The output is not read to the end, as in ``... | head``: 128 and the number of SIGPIPE."""
