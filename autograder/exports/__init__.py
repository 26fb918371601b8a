"""
Export the results of the last grading, one module per format.

=========================  ===========================================================
:mod:`.table`              CSV as in RFC 4180, safe to open in a spreadsheet
:mod:`.canvas`             a gradebook file from Canvas, with one column filled
:mod:`.moodle`             a grading worksheet from Moodle, with its grades filled
:mod:`.feedback_zip`       feedback pages under the names that Canvas and Moodle take back
:mod:`.gradescope`         ``results.json`` of each submission
:mod:`.gradescope_zip`     an autograder for Gradescope, packed from this course
:mod:`.junit`              JUnit XML, for CI servers
:mod:`.as_json`            all results as JSON, see docs/results.schema.json
=========================  ===========================================================

Each format is a pure function from results to bytes; :mod:`autograder.files` writes them.  A
submission that is for review, or missing, has no score anywhere: an empty cell, a null, a missing
file, never a zero.
"""
