"""Tools for authors of a course: release, checks of lessons and exams, the students' copy."""
