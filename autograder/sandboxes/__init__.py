"""Run student code in sandboxes with different isolation modes and with limits."""
