"""Visible exams, which a learner's notebook runs; they are shipped with the course."""
