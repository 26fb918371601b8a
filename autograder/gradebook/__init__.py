"""nbgrader's plug-ins and converters, and the only writer of its gradebook."""
