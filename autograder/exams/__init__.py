"""
The exams of the course.

``visible/`` is shipped to learners: it is what ``check(...)`` runs in their notebook.  ``hidden/``
never leaves the instructor's machine and never enters a sandbox.  Both hold one module an exam,
named like it, with a module-level ``exam``; ``autograder/exam/catalog.py`` finds them.
"""
