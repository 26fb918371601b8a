"""Read submissions: notebooks, cells, packages, code."""
