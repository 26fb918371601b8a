"""The words and pictures for a verdict, the same in notebooks, pages and on the terminal."""
