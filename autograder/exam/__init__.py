"""Define what an exam consists of: scenario, checks, specification, slips, drawn inputs."""
