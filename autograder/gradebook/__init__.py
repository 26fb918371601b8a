"""
Plug-ins for nbgrader, and the only code of the grader that writes to its gradebook.

Every function that uses the gradebook raises a GraderError if it cannot be reached, read or
written.
"""
