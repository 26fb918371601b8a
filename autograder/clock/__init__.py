"""The virtual clock of a run; README.md next to this file explains it."""
