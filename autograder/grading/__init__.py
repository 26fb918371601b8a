"""Grade one submission or a class: run what is not recorded yet, then judge."""
