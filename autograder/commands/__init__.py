"""One module per command, and the exit codes of all commands."""

OK = 0
"""Every submission has a verdict."""
FOR_REVIEW = 1
"""Some submissions are for review."""
USAGE = 2
"""The command failed: wrong arguments, or a fault of the grader."""
STOPPED = 130
"""Stopped by Ctrl-C: 128 plus the number of SIGINT."""
UNREAD = 141
"""The reader closed the output early, as in ``... | head``: 128 plus the number of SIGPIPE."""
