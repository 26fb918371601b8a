"""Words and pictures for a verdict, the same in notebooks, on pages and on the terminal."""
