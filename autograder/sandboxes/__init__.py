"""Run student code in sandboxes, with limits and one of several isolation modes."""
