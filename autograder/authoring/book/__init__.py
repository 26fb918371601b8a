"""
The course as a book, to read without running: ``python -m autograder.authoring.book``.

:mod:`.pages` executes the solved lessons and writes the pages; Sphinx turns them into HTML with
``conf.py`` and ``style.css``.  Sphinx has its own virtual environment, because its docutils is
older than the one that the course installs.
"""
