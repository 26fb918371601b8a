"""The learning platforms and folder layouts that ``collect`` reads, one module each."""
