"""Run next to a student's program, drive it and write down what it does."""
