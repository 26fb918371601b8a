"""One submission or a class: run what nobody has run yet, then judge."""
