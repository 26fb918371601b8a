"""The virtual clock of a run; README.md beside this file explains it."""
