"""Read submissions: notebooks, cells, packages and code."""
