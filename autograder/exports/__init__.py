"""
Export the results of the last grading, one module per format; ``commands/export.py`` lists them.

Each format is a pure function from marks to bytes; :mod:`autograder.files` writes them.  A
submission that is for review, or missing, has no score anywhere: it becomes an empty cell, a null
or a missing file, never a zero.
"""
