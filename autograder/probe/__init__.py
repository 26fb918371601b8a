"""Send inputs to a student's program from a process in the same network, and record its output."""
