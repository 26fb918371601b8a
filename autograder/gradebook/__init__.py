"""nbgrader's side: its plug-ins, its converters, and the one writer of its gradebook."""
