"""Visible exams: what a learner's notebook runs. Shipped with the course."""
