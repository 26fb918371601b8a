"""What students hand in, taken apart into files: notebooks, scripts, packages, archives."""
