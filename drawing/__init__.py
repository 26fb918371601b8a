"""Draw accessible SVG pictures and lay out graphs; this package imports nothing of the project."""
