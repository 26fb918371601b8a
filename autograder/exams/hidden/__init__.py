"""Hidden exams: never shipped, never inside a sandbox."""
