"""Hidden exams, which students never receive and which never enter a sandbox."""
