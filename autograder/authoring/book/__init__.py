"""
Build the course as a book of HTML pages: ``python -m autograder.authoring.book``.

:mod:`.pages` executes the solved lessons and writes the pages; Sphinx converts them to HTML with
``conf.py`` and ``style.css``.  Sphinx has a separate virtual environment, because it needs an
older version of docutils than the course installs.
"""
