"""What stands beside a student's program, drives it and writes down what it does."""
