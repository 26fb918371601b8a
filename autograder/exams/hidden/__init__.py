"""Hidden exams, which are never shipped and never enter a sandbox."""
