"""Run a program for some virtual time without an exam, and show what it did."""
