"""Pictures as SVG with words, and where their boxes go; knows nothing of the project."""
