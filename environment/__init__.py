"""Set-up of the course: finds or installs everything that `make` needs (stdlib only)."""
