"""One module a command of ``python -m autograder``, with its options and its words."""
