"""Run a program through a scenario, here or on other machines, and record it."""
