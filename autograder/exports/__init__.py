"""
Export the results of the last grading, one module per format.

=========================  ===========================================================
:mod:`.table`              CSV as in RFC 4180, safe to open in a spreadsheet
:mod:`.canvas`             a gradebook file from Canvas, with one column filled
:mod:`.gradescope`         one ``results.json`` per submission
:mod:`.gradescope_zip`     an autograder for Gradescope, packed from this course
:mod:`.junit`              JUnit XML, for CI servers
:mod:`.as_json`            all results as JSON, see docs/results.schema.json
=========================  ===========================================================

Each format is a pure function from results to bytes; :mod:`autograder.files` writes the bytes.  A
submission for review has no score, which is never written as a zero: a cell is empty, a value is
null, or the file is missing.
"""
