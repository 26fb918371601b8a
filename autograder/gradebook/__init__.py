"""Plug-ins for nbgrader, and the only code of the grader that writes to its gradebook."""
