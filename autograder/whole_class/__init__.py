"""A class from its inbox to its reports: grading, judging again, statistics, similarity."""
