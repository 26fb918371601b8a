"""A class after grading: its results, pages, numbers and people."""
