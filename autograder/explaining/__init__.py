"""Text and pictures that explain a verdict, the same in notebooks, pages and the terminal."""
