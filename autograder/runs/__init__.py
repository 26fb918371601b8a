"""Run a program through a scenario, on this machine or another one, and record the run."""
