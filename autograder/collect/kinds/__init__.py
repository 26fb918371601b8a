"""The systems that students hand in with, one module each."""
