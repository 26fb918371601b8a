"""One run of one exam: its scenario, where it takes place, and the recording that comes of it."""
