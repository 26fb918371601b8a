"""Provide the virtual clock of a run; README.md in this folder explains it."""
