"""Sandboxes for student code: isolation modes, limits, and what each mode does not protect."""
