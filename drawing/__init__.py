"""Draw accessible SVG pictures and lay out graphs; import nothing else from this project."""
