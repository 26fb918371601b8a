"""A class after grading: results, pages, statistics and names."""
