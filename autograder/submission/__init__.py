"""What a student handed in, taken apart: notebooks, cells, packages, code."""
