"""
The exams of the course.

``visible/`` is shipped to learners: ``check(...)`` runs these exams in their notebooks.
``hidden/`` is never given to students and never enters a sandbox.  Each folder has one module per
exam, with the exam's name and a global variable ``exam``;
``autograder/exam/catalog.py`` finds them.
"""
