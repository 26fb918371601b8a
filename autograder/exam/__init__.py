"""The language of exams: scenario, checks, inputs."""
