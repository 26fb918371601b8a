"""For who writes the course: release, checks of lessons and exams, the students' copy."""
