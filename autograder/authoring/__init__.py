"""Tools for authors: release a course, check its lessons and exams, pack the students' copy."""
