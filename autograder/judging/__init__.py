"""From a recording to verdicts and their causes: exams, checks, and what beginners get wrong."""
