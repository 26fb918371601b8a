"""Run a program for some virtual time without an exam, and return its messages and log lines."""
