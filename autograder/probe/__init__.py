"""Drive a student's program from a process in the same network, and record what it does."""
