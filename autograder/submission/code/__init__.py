"""Analyse students' Python code as a syntax tree, without running it."""
