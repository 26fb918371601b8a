"""Set up the course: find or install everything that `make` needs (standard library only)."""
