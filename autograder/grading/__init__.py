"""Grade one submission or a class: run the programs without a recording, then judge."""
