"""Grade one submission or a class: run programs that have no recording yet, then judge."""
